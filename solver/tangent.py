"""Element tangents of a chunk, and their way into the matrix."""

from __future__ import annotations

from collections.abc import Callable
from math import prod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .kernels import blocks, pattern
from .linear.base import Matrix
from .pattern import Pattern

if TYPE_CHECKING:
    from .group import Group

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
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
    """The matrix values under assembly and the prescribed columns times their increments, as one thread adds to them.

    ``Fd``: by matrix row, ``Fb``: the ties' share, by equation. What elements of other threads add to as well the
    first thread alone adds to at once; the others keep it for :meth:`finish`, when all are done: sums have one order,
    and the same bits each time.
    """

    def __init__(self, pat: Pattern, A: Matrix, step: Floats, Fd: Floats, Fb: Floats, first: bool) -> None:
        self.pat, self.A, self.data, self.step, self.Fd, self.Fb, self.first = pat, A, A.data, step, Fd, Fb, first
        self._left: list[Callable[[], None]] = []

    def finish(self) -> None:
        """Add what was kept, one thread after another."""
        for add in self._left:
            add()
        self._left.clear()

    def add_blocks(self, g: Group, lo: int, hi: int, B: Floats, U: Floats) -> None:
        """Add upper blocks of elements lo:hi."""
        p, nd = self.pat, len(g.columns) * g.n
        at = p.unknowns(g)
        if not at.ordered:  # the blocks are of the upper triangle for columns that ascend alone
            K = np.empty((hi - lo, nd, nd))
            blocks.expand(hi - lo, B, U, False, K)
            self.add(g, lo, hi, K)
            return
        conn, back = g.conn[lo:hi], p.back(g)[lo:hi]

        def put(some: NDArray[np.bool_], B: Floats, U: Floats, conn: Ints, back: Ints) -> None:
            rest = (at.row, at.given, p.lead, at.size, p.indptr, self.data, self.step, self.Fd)
            pattern.scatter_upper(0, len(conn), some, B, U, conn, back, *rest)

        contended = p.contended(g)[lo:hi]
        put(~contended, B, U, conn, back)
        if self.first:
            put(contended, B, U, conn, back)
        elif contended.any():
            kept = B[contended], U[contended] if len(U) else U, conn[contended], back[contended]
            self._left.append(lambda: put(np.ones(len(kept[0]), bool), *kept))
        if p.ties is not None:
            rows = p.tied(g, lo, hi)
            if len(rows):
                K = np.empty((len(rows), nd, nd))
                blocks.expand(len(rows), B[rows - lo], U[rows - lo] if len(U) else U, False, K)
                self._condense(g, rows, K)

    def add(self, g: Group, lo: int, hi: int, K: Floats) -> None:
        """Add full matrices K (hi - lo, c n, c n) of elements lo:hi, component-major over the group's columns."""
        p, at = self.pat, self.pat.unknowns(g)
        conn, back = g.conn[lo:hi], p.back(g)[lo:hi]

        def put(K: Floats, conn: Ints, back: Ints) -> None:
            rest = (at.row, at.given, p.lead, p.indptr, self.data, self.step, self.Fd, p.symmetric)
            pattern.scatter(0, len(K), K, conn, back, *rest)

        contended = p.contended(g)[lo:hi]
        if self.first or not contended.any():
            put(K, conn, back)
        else:
            own, kept = ~contended, (K[contended], conn[contended], back[contended])
            put(K[own], conn[own], back[own])
            self._left.append(lambda: put(*kept))
        if p.ties is not None:
            rows = p.tied(g, lo, hi)
            if len(rows):
                self._condense(g, rows, K[rows - lo])

    def _condense(self, g: Group, rows: NDArray[np.int64], K: Floats) -> None:
        """Add matrices K of elements ``rows`` at the masters of tied unknowns."""
        columns, nodes = np.repeat(g.columns, g.n), np.tile(g.conn[rows], (1, len(g.columns)))

        def put() -> None:
            ties = self.pat.ties
            assert ties is not None
            ties.scatter(self.pat.eqs, self.A, K, nodes, columns, self.step, self.Fb)

        if self.first:
            put()
        else:
            self._left.append(put)


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
