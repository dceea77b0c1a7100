"""Tangents inverted without a factorisation: flexible GMRES over a block preconditioner.

The tangent of a biphasic step is [K, C; D, -W] in displacements and pressures. Its preconditioner is the upper
triangle [K, C; 0, -S], with K^-1 a multigrid cycle whose coarse spaces hold the rigid body modes, and S the
fixed-stress operator W + M_p / H: C^T K^-1 C acts on a pressure as its mass matrix over the aggregate modulus H
(exactly so in one dimension). White, Castelletto and Tchelepi, Comput Methods Appl Mech Engrg 303 (2016); Vanek,
Mandel and Brezina, Computing 56 (1996).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .amg import Multigrid, require, rigid_modes
from .base import Floats, Matrix, Stalled, Unknowns
from .krylov import fgmres, matvec

TOLERANCE = 1e-4  # of a solve, in units in which the preconditioner's diagonal is one
USABLE = 1e-3  # a residual from which Newton's iteration goes on where TOLERANCE was not reached
RESTART, MOST = 60, 300
STRENGTH = 0.0  # couplings weaker than this (of the diagonal) do not form aggregates
SETUP = 30  # iterations that take as long as setting up the elastic hierarchy


class Iterative:
    """FGMRES over multigrid of the elastic block and of the fixed-stress pressure block.

    Solid models have the elastic block alone. Raises LinearError where pyamg is missing.
    """

    def __init__(self, unknowns: Unknowns, tolerance: float = TOLERANCE) -> None:
        require()
        self.name = "FGMRES over multigrid (pyamg)"
        self.stats: dict[str, float] = {}
        self.tolerance = tolerance
        self._unknowns = unknowns
        pressure = unknowns.component < 0
        self._u, self._p = np.flatnonzero(~pressure), np.flatnonzero(pressure)
        nodes, block = np.unique(unknowns.node[self._u], return_inverse=True)
        self._padded = 3 * block + unknowns.component[self._u]  # place of each displacement among three per node
        self._free = np.zeros(3 * len(nodes), bool)
        self._free[self._padded] = True
        self._modes = rigid_modes(unknowns.X[nodes], self._free.reshape(-1, 3))
        self._A: Matrix | None = None
        self._elastic: Multigrid | None = None
        self._fluid: Multigrid | None = None
        self._fresh = 0  # iterations of the first solve over the present elastic hierarchy
        self._wasted = 0  # iterations that solves over it have taken beyond as many

    # ---- preconditioner ---------------------------------------------------------------------------
    def factor(self, A: Matrix) -> None:
        """Make the preconditioner of A, which is kept until the next call.

        The elastic hierarchy of an earlier tangent serves on until the iterations it has cost come to a set-up.
        """
        self._fluid = self._A = None
        M = _full(A)
        K, d = M[self._u][:, self._u], np.ones(A.n)
        d[self._u] = np.abs(K.diagonal())
        if len(self._u) and (self._elastic is None or self._wasted >= SETUP):
            self._elastic, self._fresh, self._wasted = None, 0, 0
            self._elastic = self._multigrid(K)
            self.stats["set_ups"] = self.stats.get("set_ups", 0.0) + 1
        entries = self._elastic.entries if self._elastic else 0
        if len(self._p):
            self._C = M[self._u][:, self._p].tocsr()
            S = _symmetric(-M[self._p][:, self._p] + self._unknowns.storage())
            d[self._p] = np.abs(S.diagonal())
            self._fluid = Multigrid(S, np.ones((len(self._p), 1)), STRENGTH)
            entries += self._fluid.entries + self._C.nnz
        self._scale = 1.0 / np.sqrt(np.where(d > 0, d, 1.0))
        self._A = A
        done = {name: self.stats.get(name, 0.0) for name in ("solves", "iterations", "set_ups")}
        self.stats = {"equations": A.n, "entries": len(A.data), "preconditioner_kB": entries * 12 / 1024, **done}

    def _multigrid(self, K: Any) -> Multigrid:
        """The hierarchy of the elastic block, three unknowns a node; those that are held stand alone."""
        from scipy.sparse import coo_matrix

        K, n = K.tocoo(), len(self._free)
        held = np.flatnonzero(~self._free)
        at = self._padded
        rows, columns = np.concatenate([at[K.row], held]), np.concatenate([at[K.col], held])
        values = np.concatenate([K.data, np.full(len(held), np.abs(K.data).max())])
        full = coo_matrix((values, (rows, columns)), shape=(n, n)).tocsr()
        return Multigrid(_symmetric(full).tobsr((3, 3)), self._modes, STRENGTH)

    def _precondition(self, r: Floats) -> Floats:
        z, r = np.zeros_like(r), r / self._scale
        ru = r[self._u]
        if self._fluid is not None:
            zp = -self._fluid.cycle(r[self._p])
            z[self._p] = zp
            ru = ru - self._C @ zp
        if self._elastic is not None:
            padded = np.zeros(len(self._free))
            padded[self._padded] = ru
            z[self._u] = self._elastic.cycle(padded)[self._padded]
        return z / self._scale

    # ---- solves -----------------------------------------------------------------------------------
    def solve(self, b: Floats) -> Floats:
        """A^-1 b to the tolerance. Raises Stalled where the iteration comes to nothing."""
        A, d = self._A, self._scale
        assert A is not None
        x, error, used = fgmres(
            lambda v: d * matvec(A, d * v), d * b, self._precondition, self.tolerance, RESTART, MOST
        )
        self.stats["solves"] += 1
        self.stats["iterations"] += used
        self._fresh = self._fresh or used
        self._wasted += max(0, used - self._fresh)
        if not error < USABLE:
            self._wasted = SETUP
            raise Stalled(
                f"the iterative solver stalled: relative residual {error:.2g} after {used} iterations "
                "(a body that is not held, or nearly incompressible? try --linear pardiso)"
            )
        return d * x

    def close(self) -> None:
        """Free the hierarchies."""
        self._elastic = self._fluid = None
        self._A = None


def _full(A: Matrix) -> Any:
    """A with both triangles, compressed rows."""
    from scipy.sparse import csr_matrix, triu

    M = csr_matrix((A.data, A.indices, A.indptr), shape=(A.n, A.n))
    return (M + triu(M, 1, format="csr").T).tocsr() if A.symmetric else M


def _symmetric(M: Any) -> Any:
    return (0.5 * (M + M.T)).tocsr()
