"""Element tangents of a chunk, and their way into the matrix."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .kernels import biphasic, blocks, pattern, projection, solid, three_field
from .linear.base import Matrix
from .pattern import Pattern
from .state import State

if TYPE_CHECKING:
    from .group import Chunk, Group

Floats = NDArray[np.float64]
CACHE = 600_000  # bytes of factors worked on at a time
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
        p, back = self.pat, self.pat.back(g)
        contended = p.contended(g)[lo:hi]
        rest = (p.row, p.given, p.lead, p.size, p.indptr, self.data, self.step, self.Fd)
        pattern.scatter_upper(lo, hi, ~contended, B, U, g.conn, back, *rest)
        if contended.any():
            with self.lock:
                pattern.scatter_upper(lo, hi, contended, B, U, g.conn, back, *rest)
        if p.ties is not None:
            rows = p.tied(g, lo, hi)
            if len(rows):
                K = np.empty((len(rows), g.columns * g.n, g.columns * g.n))
                blocks.expand(len(rows), B[rows - lo], U[rows - lo] if len(U) else U, False, K)
                self._condense(g, rows, K)

    def _condense(self, g: Group, rows: NDArray[np.int64], K: Floats) -> None:
        """Add matrices K of elements ``rows`` at the masters of tied unknowns."""
        p = self.pat
        assert p.ties is not None
        columns = np.repeat(np.arange(g.columns), g.n)
        with self.lock:
            p.ties.scatter(p.eqs, self.A, K, np.tile(g.conn[rows], (1, g.columns)), columns, self.step, self.Fb)

    def add(self, g: Group, lo: int, hi: int, K: Floats) -> None:
        """Add full matrices K (hi - lo, c n, c n) of elements lo:hi."""
        p = self.pat
        with self.lock:
            pattern.scatter(
                lo, hi, K, g.conn, p.back(g), p.row, p.given, p.lead, p.indptr, self.data, self.step, self.Fd,
                p.symmetric,
            )  # fmt: skip
        if p.ties is not None:
            rows = p.tied(g, lo, hi)
            if len(rows):
                self._condense(g, rows, K[rows - lo])


@dataclass(slots=True)
class _Laws:
    """What the laws of a chunk give at its points (s, C, k, dk, supply) and in its elements (bulk)."""

    s: Floats
    C: Floats
    k: Floats | None = None
    dk: Floats | None = None
    supply: tuple[Floats, Floats, Floats] | None = None
    bulk: Floats | None = None

    def part(self, elements: slice, points: slice) -> _Laws:
        """Those of some of its elements."""
        k, dk, supply, bulk = self.k, self.dk, self.supply, self.bulk
        return _Laws(
            self.s[points], self.C[points], None if k is None else k[points], None if dk is None else dk[points],
            None if supply is None else (supply[0][points], supply[1][points], supply[2][points]),
            None if bulk is None else bulk[elements].copy(),
        )  # fmt: skip


def add_chunk(g: Group, c: Chunk, state: State, target: Target, work: Workspace, steady: bool) -> None:
    """Add the tangents of a chunk's elements to ``target``."""
    q = (c.hi - c.lo) * g.g
    laws = _Laws(work.zeros("s", q, 6), work.zeros("C", q, 6, 6))
    pts, mix = c.points, g.block.mixture
    pts.t, pts.dt = state.time, state.dt
    if g.block.formulation == "three-field":
        _three_field(g, c, laws.s, laws.C)
        laws.bulk = g.dilatation_modulus(c)
    else:
        g.block.solid.stress(pts, laws.s, laws.C)
    if mix is not None:
        laws.k, laws.dk = g.permeability(c, tangent=True)
        laws.supply = g.supply_tangent(c) if mix.supply is not None else None
    size = max(8, CACHE // (8 * 3 * g.g * 7 * g.n))
    for lo in range(c.lo, c.hi, size):
        hi = min(lo + size, c.hi)
        part = laws.part(slice(lo - c.lo, hi - c.lo), slice((lo - c.lo) * g.g, (hi - c.lo) * g.g))
        _add(g, lo, hi, part, state.dt, target, work, steady)


def _add(
    g: Group, lo: int, hi: int, laws: _Laws, dt: float, target: Target, work: Workspace, steady: bool
) -> None:  # fmt: skip
    fluid, n, nd = laws.k is not None, hi - lo, g.n * g.columns
    geometry = (g.dN, g.iJ0, g.wJ0, g.F, g.J)
    stab = g.steady_pressure if fluid and not steady else None
    extra = laws.dk is not None or laws.bulk is not None or laws.supply is not None or (fluid and steady)
    if g.block.solid.symmetric:
        B, U = _blocks(g, lo, hi, laws.s, laws.C, laws.k, dt, work)
        if stab is not None:
            projection.tangent(lo, hi, g.N, g.wJ0, stab, B, 6 * g.n, 0)
        if target.pat.symmetric and not extra:
            target.add_blocks(g, lo, hi, B, U)
            return
        K = work.take("K", n, nd, nd)
        blocks.expand(n, B, U, steady, K)
    else:
        K = work.take("K", n, nd, nd)
        se, Ce = laws.s.reshape(-1, g.g, 6), laws.C.reshape(-1, g.g, 6, 6)
        if laws.k is None:
            solid.stiffness(lo, hi, *geometry, se, Ce, K)
        else:
            biphasic.stiffness(lo, hi, g.N, *geometry, se, Ce, g.pg, laws.k, dt, steady, K)
            if stab is not None:
                projection.tangent(lo, hi, g.N, g.wJ0, stab, K, 3 * g.n, 3 * g.n)
    if laws.dk is not None:
        biphasic.permeability_coupling(lo, hi, *geometry, g.gp, laws.dk, dt, K)
    if laws.supply is not None:
        biphasic.supply_coupling(lo, hi, g.N, *geometry, *laws.supply, dt, K)
    if laws.bulk is not None:
        three_field.dilatation(lo, hi, *geometry, laws.bulk, K)
    target.add(g, lo, hi, K)


def _blocks(
    g: Group, lo: int, hi: int, s: Floats, C: Floats, k: Floats | None, dt: float, work: Workspace
) -> tuple[Floats, Floats]:
    """Blocks (e, 6|7 n, n) and couplings (e, 3 n, n) of elements lo:hi; see :mod:`.kernels.blocks`."""
    m, q, n, fluid = hi - lo, (hi - lo) * g.g, g.n, k is not None
    R = (7 if fluid else 6) * n
    T, G = work.take("T", q * 3 * R), work.take("G", q * 3 * n)
    P = work.take("P", q * n if fluid else 0)
    pg = g.pg if fluid else _NONE
    blocks.factors(n, fluid)(
        lo, hi, g.dN, g.iJ0, g.wJ0, g.F, g.J, s, C, g.N, pg, _NONE if k is None else k, dt, T, G, P
    )
    B = work.take("B", m, R, n)
    np.matmul(T.reshape(m, 3 * g.g, R).transpose(0, 2, 1), G.reshape(m, 3 * g.g, n), out=B)
    if not fluid:
        return B, _NO_BLOCKS
    U = work.take("U", m, 3 * n, n)
    np.matmul(G.reshape(m, g.g, 3 * n).transpose(0, 2, 1), P.reshape(m, g.g, n), out=U)
    return B, U


def _three_field(g: Group, c: Chunk, s: Floats, C: Floats) -> None:
    """Deviatoric law and the element pressure's share of stress and tangent."""
    g.block.solid.dev(c.points, s, C)  # type: ignore[attr-defined]
    p = np.repeat(g.ep[c.lo : c.hi], g.g)
    s[:, :3] += p[:, None]
    C[:, :3, :3] += p[:, None, None] * (1.0 - 2.0 * np.eye(3))
    C[:, [3, 4, 5], [3, 4, 5]] -= p[:, None]
