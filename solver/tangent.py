"""Element tangents of a chunk, and their way into the matrix."""

from __future__ import annotations

from math import prod
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .kernels import blocks, pattern
from .linear.base import Matrix
from .pattern import Pattern

if TYPE_CHECKING:
    from .group import Group

Floats = NDArray[np.float64]
_NO_BLOCKS = np.empty((0, 0, 0))
_NONE = np.empty((0, 0))


class Workspace:
    """Buffers of one thread, grown as needed and used again."""

    def __init__(self) -> None:
        self._held: dict[str, Floats] = {}

    def take(self, name: str, *shape: int) -> Floats:
        """An uninitialised array."""
        n = prod(shape)
        held = self._held.get(name)
        if held is None or held.size < n:
            held = self._held[name] = np.empty(n)
        return held[:n].reshape(shape)

    def zeros(self, name: str, *shape: int) -> Floats:
        out = self.take(name, *shape)
        out[...] = 0.0
        return out


class Target:
    """The matrix values under assembly and the prescribed columns times their increments, by matrix row."""

    def __init__(self, pat: Pattern, A: Matrix, step: Floats) -> None:
        self.pat, self.A, self.data, self.step = pat, A, A.data, step
        self.Fd = np.zeros(len(pat.indptr) - 1)
        self.Fb = np.zeros(pat.eqs.n if pat.ties is not None else 0)  # the ties' share, by equation
        self.lock = Lock()

    def add_blocks(self, g: Group, lo: int, hi: int, B: Floats, U: Floats) -> None:
        """Add upper blocks of elements lo:hi: contended ones one thread at a time."""
        p, nd = self.pat, len(g.columns) * g.n
        at = p.unknowns(g)
        if not at.ordered:  # the blocks are of the upper triangle for columns that ascend alone
            K = np.empty((hi - lo, nd, nd))
            blocks.expand(hi - lo, B, U, False, K)
            self.add(g, lo, hi, K)
            return
        contended, back = p.contended(g)[lo:hi], p.back(g)
        rest = (at.row, at.given, p.lead, at.size, p.indptr, self.data, self.step, self.Fd)
        pattern.scatter_upper(lo, hi, ~contended, B, U, g.conn, back, *rest)
        if contended.any():
            with self.lock:
                pattern.scatter_upper(lo, hi, contended, B, U, g.conn, back, *rest)
        if p.ties is not None:
            rows = p.tied(g, lo, hi)
            if len(rows):
                K = np.empty((len(rows), nd, nd))
                blocks.expand(len(rows), B[rows - lo], U[rows - lo] if len(U) else U, False, K)
                self._condense(g, rows, K)

    def _condense(self, g: Group, rows: NDArray[np.int64], K: Floats) -> None:
        """Add matrices K of elements ``rows`` at the masters of tied unknowns."""
        p = self.pat
        assert p.ties is not None
        columns, nodes = np.repeat(g.columns, g.n), np.tile(g.conn[rows], (1, len(g.columns)))
        with self.lock:
            p.ties.scatter(p.eqs, self.A, K, nodes, columns, self.step, self.Fb)

    def add(self, g: Group, lo: int, hi: int, K: Floats) -> None:
        """Add full matrices K (hi - lo, c n, c n) of elements lo:hi, component-major over the group's columns."""
        p, at = self.pat, self.pat.unknowns(g)
        with self.lock:
            pattern.scatter(
                lo, hi, K, g.conn, p.back(g), at.row, at.given, p.lead, p.indptr, self.data, self.step, self.Fd,
                p.symmetric,
            )  # fmt: skip
        if p.ties is not None:
            rows = p.tied(g, lo, hi)
            if len(rows):
                self._condense(g, rows, K[rows - lo])


def upper_blocks(
    g: Group, lo: int, hi: int, s: Floats, C: Floats, work: Workspace, fluid: tuple[Floats, Floats, float] | None = None
) -> tuple[Floats, Floats]:
    """Blocks (e, 6|7 n, n) and couplings (e, 3 n, n) of elements lo:hi; see :mod:`.kernels.blocks`.

    s (., 6), C (., 6, 6): stress and tangent of the solid at their points; ``fluid``: pressures (m, g), permeabilities
    (., 6) at the points and the step size, for elements with a fluid pressure.
    """
    m, q, n = hi - lo, (hi - lo) * g.g, g.n
    p, k, dt = (_NONE, _NONE, 0.0) if fluid is None else fluid
    R = (6 if fluid is None else 7) * n
    T, G = work.take("T", q * 3 * R), work.take("G", q * 3 * n)
    P = work.take("P", 0 if fluid is None else q * n)
    blocks.factors(n, fluid is not None)(
        lo, hi, g.dN, g.iJ0, g.wJ0, g.F, g.J, s, C, g.N, p, k, dt, T, G, P
    )
    B = work.take("B", m, R, n)
    np.matmul(T.reshape(m, 3 * g.g, R).transpose(0, 2, 1), G.reshape(m, 3 * g.g, n), out=B)
    if fluid is None:
        return B, _NO_BLOCKS
    U = work.take("U", m, 3 * n, n)
    np.matmul(G.reshape(m, g.g, 3 * n).transpose(0, 2, 1), P.reshape(m, g.g, n), out=U)
    return B, U
