"""MKL PARDISO through a thin ctypes binding to the ``mkl`` wheel's runtime library.

LDL^T for symmetric storage (matrix type -2), LU for the rest (type 11). The reordering is computed once per pattern.
Source: Intel oneMKL developer reference, "oneMKL PARDISO - Parallel Direct Sparse Solver Interface".

Tangents of solids are positive definite, those with pressures quasi-definite: both have an LDL^T in any order without
pivoting (Vanderbei, SIAM J Optim 5, 1995), at two thirds of the time that Bunch and Kaufman's takes. Theirs is taken
from where a pivot was perturbed, or where a matrix that is not positive definite is not solved well; and with contact,
where rounding may decide which facet a node meets, and FEBio's is that of these pivots.
"""

from __future__ import annotations

import ctypes
import os
import sys
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..vectors import norm
from .base import Floats, LinearError, Matrix
from .krylov import matvec

OFF = {False: 1e-8, True: 1e-2}  # residual over right-hand side, by precision, from which pivots are looked for

_ERRORS = {
    -1: "inconsistent input", -2: "not enough memory (try --linear iterative)", -3: "reordering failed",
    -4: "zero pivot: the matrix is singular (a body or node is not held?)", -5: "internal error",
    -6: "preordering failed", -7: "diagonal matrix is singular", -8: "32-bit integer overflow",
    -9: "not enough memory for out-of-core", -10: "cannot open out-of-core files",
}  # fmt: skip


def _candidates() -> list[Path]:
    roots = {Path(sys.prefix), Path(sys.base_prefix), Path(__file__).resolve().parents[3]}
    names = ["Library/bin/mkl_rt.*.dll"] if os.name == "nt" else ["lib/libmkl_rt.so*", "lib/libmkl_rt*.dylib"]
    return [p for r in sorted(roots) for n in names for p in sorted(r.glob(n), reverse=True)]


@lru_cache(maxsize=1)
def library() -> ctypes.CDLL | None:
    """The MKL runtime, or None where its wheel is not installed."""
    os.environ.setdefault("MKL_INTERFACE_LAYER", "LP64")
    for p in _candidates():
        try:
            lib = ctypes.CDLL(str(p))
            _ = lib.pardiso
        except (OSError, AttributeError):
            continue
        return lib
    return None


class Analysis:
    """PARDISO's memory of one pattern, its order of elimination and the factor made last; freed with this object."""

    def __init__(self, lib: ctypes.CDLL, A: Matrix) -> None:
        self.lib, self.indptr, self.indices, self.symmetric = lib, A.indptr, A.indices, A.symmetric
        self.pt, self.iparm = np.zeros(64, np.int64), np.zeros(64, np.int32)
        self.used = False

    def of(self, A: Matrix) -> bool:
        """Is it that of A's pattern?"""
        return self.indptr is A.indptr and self.indices is A.indices and self.symmetric == A.symmetric

    def call(self, phase: int, data: NDArray, b: NDArray, x: NDArray) -> int:
        error = ctypes.c_int(0)
        self.used = True

        def i(v: int) -> ctypes._CArgObject:  # type: ignore[name-defined]
            return ctypes.byref(ctypes.c_int(v))

        def p(a: NDArray) -> ctypes.c_void_p:
            return a.ctypes.data_as(ctypes.c_void_p)

        self.lib.pardiso(
            p(self.pt), i(1), i(1), i(-2 if self.symmetric else 11), i(phase), i(len(self.indptr) - 1),
            p(data), p(self.indptr), p(self.indices), p(np.zeros(1, np.int32)), i(1 if b.ndim == 1 else b.shape[0]),
            p(self.iparm), i(0), p(b), p(x), ctypes.byref(error),
        )  # fmt: skip
        return error.value

    def rest(self) -> bool:
        """Free the factor alone; whether the order, which does not depend on values, is left."""
        return self.symmetric and self.used and self._free(0) == 0

    def free(self) -> None:
        if self.used:
            self._free(-1)
            self.pt[:], self.used = 0, False

    def _free(self, phase: int) -> int:
        z = np.zeros(1)
        return self.call(phase, z, z, z)

    def __del__(self) -> None:
        with suppress(Exception):  # interpreter shutdown
            self.free()


class Pardiso:
    """Direct solver. ``single`` keeps the factor in single precision (as a preconditioner).

    ``mixed``: displacements and pressures, or penalties, whose pivots differ by many orders of magnitude.
    ``pivoting``: Bunch and Kaufman's from the first factorisation on.
    """

    def __init__(self, threads: int = 1, single: bool = False, mixed: bool = False, pivoting: bool = False) -> None:
        lib = library()
        if lib is None:
            raise LinearError("MKL is not installed")
        self._lib, self._threads = lib, threads
        self.name = "MKL PARDISO"
        self.single, self.mixed = single, mixed
        self.pivoting = pivoting
        self.stats: dict[str, float] = {"pivoting": float(pivoting)}
        self._own: Analysis | None = None
        self._A: Matrix | None = None
        self._data: NDArray | None = None

    @property
    def _kind(self) -> tuple[object, ...]:
        """What an analysis depends on beside the pattern."""
        return type(self), self._threads, self.single, self.mixed, self.pivoting

    def _setup(self, A: Matrix, ip: NDArray[np.int32]) -> None:
        ip[0] = 1  # own settings below
        ip[1] = 3 if A.n > 20000 else 2  # nested dissection (parallel for large graphs)
        ip[7] = 0  # no iterative refinement: Newton corrects
        # pivots below 1e-8 |A| are perturbed as FEBio has it, or 1e-13: pressures of small elements have sound ones
        ip[9] = 8 if A.symmetric and not self.mixed else 13
        ip[10] = 0 if A.symmetric else 1  # scaling
        ip[12] = 0 if A.symmetric else 1  # matching: quasi-definite matrices need none
        ip[17] = -1  # report factor entries
        # several threads add in an order that does not depend on how busy each is: the same system has the same bits
        several = self._threads > 1
        ip[33] = self._threads if several else 0
        # in two levels, without which solves by LDL^T would be one thread's then
        ip[23] = int(several or (A.n > 5000 and (self.pivoting or not A.symmetric)))
        ip[27] = int(self.single)
        ip[34] = 1  # 0-based

    def memory(self, A: Matrix) -> float:
        """Bytes that a factorisation of A's pattern takes, by its analysis.

        LDL^T keeps the analysis for the factorisation; that of LU depends on values and is made anew with them.
        """
        if A.symmetric:
            own = self._analyse(A)
        else:
            rows = np.repeat(np.arange(A.n, dtype=np.int32), np.diff(A.indptr))
            own = self._analyse(Matrix(A.indptr, A.indices, (A.indices == rows).astype(float), False))
        ip = own.iparm
        need = 1024.0 * max(float(ip[14]), float(ip[15]) + float(ip[16]))
        if not A.symmetric:
            self.close()
        return need

    def _analyse(self, A: Matrix) -> Analysis:
        """Order the unknowns, once as long as the pattern arrays stay the same objects, over runs that share them."""
        self._lib.MKL_Set_Num_Threads(ctypes.c_int(self._threads))
        if self._own is not None and self._own.of(A):
            return self._own
        self.close()
        self._own, self._A = A.take(self._kind), A
        if self._own is None:
            self._own = Analysis(self._lib, A)
            self._setup(A, self._own.iparm)
            self._phase(11, A, self._own)
        return self._own

    def _phase(self, phase: int, A: Matrix, own: Analysis) -> None:
        self._A = A
        self._data = A.data.astype(np.float32) if self.single else A.data
        z = np.zeros(1, self._data.dtype)
        err = own.call(phase, self._data, z, z)
        if err:
            self._own = None
            own.free()
            raise LinearError(f"MKL PARDISO: {_ERRORS.get(err, f'error {err}')}")

    def factor(self, A: Matrix) -> None:
        """Factorise; the analysis is reused while the pattern arrays stay the same objects."""
        own, pivoting = self._analyse(A), self.stats["pivoting"]
        ip = own.iparm
        ip[20] = int(pivoting)  # Bunch and Kaufman's, or the diagonal ones
        self._phase(22, A, own)
        self.stats = {
            "equations": A.n, "entries": len(A.data), "factor_entries": float(ip[17]),
            "factor_kB": float(max(ip[14], ip[15] + ip[16])), "perturbed_pivots": float(ip[13]), "pivoting": pivoting,
        }  # fmt: skip
        if A.symmetric and not pivoting and (ip[13] or (ip[22] and not self._sound(A))):
            self.stats["pivoting"] = 1.0
            self.factor(A)

    def _sound(self, A: Matrix) -> bool:
        """Does the factor solve an equation?"""
        b = np.cos(np.arange(A.n, dtype=float))
        return norm(b - matvec(A, self.solve(b))) <= OFF[self.single] * norm(b)

    def solve(self, b: Floats) -> Floats:
        assert self._own is not None and self._data is not None
        b = np.ascontiguousarray(b, dtype=np.float32 if self.single else np.float64)
        x = np.empty_like(b)
        err = self._own.call(33, self._data, b, x)
        if err:
            raise LinearError(f"MKL PARDISO: {_ERRORS.get(err, f'error {err}')}")
        return x.astype(np.float64, copy=False)

    def close(self) -> None:
        """Free the factor, and leave the analysis to the next solver of the pattern where this one is shared."""
        own, self._own = self._own, None
        if own is None or self._A is None:
            return
        if self._A.kept is not None and own.rest():
            self._A.give(self._kind, own)
        else:
            own.free()
