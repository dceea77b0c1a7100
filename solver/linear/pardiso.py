"""MKL PARDISO through a thin ctypes binding to the ``mkl`` wheel's runtime library.

LDL^T with Bunch-Kaufman pivoting inside supernodes for symmetric storage (matrix type -2), LU for the
rest (type 11). The reordering is computed once per pattern. Source: Intel oneMKL developer reference,
"oneMKL PARDISO - Parallel Direct Sparse Solver Interface".
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

from .base import Floats, LinearError, Matrix

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


class Pardiso:
    """Direct solver. ``single`` keeps the factor in single precision (as a preconditioner).

    ``mixed``: displacements and pressures, or penalties, whose pivots differ by many orders of magnitude.
    """

    def __init__(self, threads: int = 0, single: bool = False, mixed: bool = False) -> None:
        lib = library()
        if lib is None:
            raise LinearError("MKL is not installed")
        self._lib = lib
        if threads:
            lib.MKL_Set_Num_Threads(ctypes.c_int(threads))
        self.name = "MKL PARDISO"
        self.single, self.mixed = single, mixed
        self.stats: dict[str, float] = {}
        self._pt = np.zeros(64, np.int64)
        self._iparm = np.zeros(64, np.int32)
        self._key: tuple[int, int, bool] | None = None
        self._A: Matrix | None = None
        self._ones: NDArray[np.int32] | None = None
        self._data: NDArray | None = None

    def _call(self, phase: int, b: NDArray, x: NDArray) -> int:
        A = self._A
        assert A is not None and self._data is not None
        error = ctypes.c_int(0)

        def i(v: int) -> ctypes._CArgObject:  # type: ignore[name-defined]
            return ctypes.byref(ctypes.c_int(v))

        def p(a: NDArray) -> ctypes.c_void_p:
            return a.ctypes.data_as(ctypes.c_void_p)

        nrhs = 1 if b.ndim == 1 else b.shape[0]
        self._lib.pardiso(
            p(self._pt), i(1), i(1), i(-2 if A.symmetric else 11), i(phase), i(A.n),
            p(self._data), p(A.indptr), p(A.indices), p(np.zeros(1, np.int32)), i(nrhs),
            p(self._iparm), i(0), p(b), p(x), ctypes.byref(error),
        )  # fmt: skip
        return error.value

    def _setup(self, A: Matrix) -> None:
        ip = self._iparm
        ip[:] = 0
        ip[0] = 1  # own settings below
        ip[1] = 3 if A.n > 20000 else 2  # nested dissection (parallel for large graphs)
        ip[7] = 0  # no iterative refinement: Newton corrects
        # pivots below 1e-8 |A| are perturbed as FEBio has it, or 1e-13: pressures of small elements have sound ones
        ip[9] = 8 if A.symmetric and not self.mixed else 13
        ip[10] = 0 if A.symmetric else 1  # scaling
        ip[12] = 0 if A.symmetric else 1  # matching: quasi-definite matrices need none
        ip[17] = -1  # report factor entries
        ip[20] = 1  # Bunch-Kaufman
        ip[23] = 1 if A.n > 5000 else 0  # two-level factorisation
        ip[27] = int(self.single)
        ip[34] = 1  # 0-based

    def memory(self, A: Matrix) -> float:
        """Bytes that a factorisation of A's pattern takes, by its analysis.

        LDL^T keeps the analysis for the factorisation; that of LU depends on values and is made anew with them.
        """
        if A.symmetric:
            self._analyse(A)
        else:
            rows = np.repeat(np.arange(A.n, dtype=np.int32), np.diff(A.indptr))
            self._analyse(Matrix(A.indptr, A.indices, (A.indices == rows).astype(float), False))
        need = 1024.0 * max(float(self._iparm[14]), float(self._iparm[15]) + float(self._iparm[16]))
        if not A.symmetric:
            self.close()
        return need

    def _analyse(self, A: Matrix) -> None:
        """Order the unknowns, once as long as the pattern arrays stay the same objects."""
        key = (id(A.indptr), id(A.indices), A.symmetric)
        if key != self._key:
            self.close()
            self._A, self._key = A, key
            self._setup(A)
            self._phase(11, A)

    def _phase(self, phase: int, A: Matrix) -> None:
        self._A = A
        self._data = A.data.astype(np.float32) if self.single else A.data
        z = np.zeros(1, self._data.dtype)
        err = self._call(phase, z, z)
        if err:
            self._key = None
            raise LinearError(f"MKL PARDISO: {_ERRORS.get(err, f'error {err}')}")

    def factor(self, A: Matrix) -> None:
        """Factorise; the analysis is reused while the pattern arrays stay the same objects."""
        self._analyse(A)
        self._phase(22, A)
        self.stats = {
            "equations": A.n, "entries": len(A.data), "factor_entries": float(self._iparm[17]),
            "factor_kB": float(max(self._iparm[14], self._iparm[15] + self._iparm[16])),
            "perturbed_pivots": float(self._iparm[13]),
        }  # fmt: skip

    def solve(self, b: Floats) -> Floats:
        dtype = np.float32 if self.single else np.float64
        b = np.ascontiguousarray(b, dtype=dtype)
        x = np.empty_like(b)
        err = self._call(33, b, x)
        if err:
            raise LinearError(f"MKL PARDISO: {_ERRORS.get(err, f'error {err}')}")
        return x.astype(np.float64, copy=False)

    def close(self) -> None:
        """Free the factor."""
        if self._key is not None and self._A is not None:
            z = np.zeros(1)
            self._call(-1, z, z)
        self._key = None
        self._pt[:] = 0

    def __del__(self) -> None:
        with suppress(Exception):  # interpreter shutdown
            self.close()
