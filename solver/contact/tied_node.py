"""Nodes, or integration points, of one surface tied to the closest points of another."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..kernels import contact
from . import register
from .base import Contact, Floats, Ints, Matrices, Progress, Side, Surface, matrices

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


class TiedSide(Side):
    """gap (q, 3) of each point from its partner, less that at the start where this counts; multiplier (q, 3)."""

    memory = (*Side.memory, "multiplier", "gap")

    def __init__(self, *args: object) -> None:
        super().__init__(*args)  # type: ignore[arg-type]
        self.multiplier, self.gap, self.start = np.zeros((self.n, 3)), np.zeros((self.n, 3)), np.zeros((self.n, 3))
        self.partner_normals = np.zeros((self.n, 3))

    @property
    def offset(self) -> Floats:
        """Half the thickness of shells at the points (nodes)."""
        return self.surface.shell_offset if self.nodal else np.zeros(0)


@dataclass(eq=False)
class TiedNode(Contact):
    """A traction L + eps g per reference area holds each primary node to the point it projects on at the start.

    g = x - q - h n, q being that point, h half the thickness of a shell. FEBio User Manual, "Tied Node-on-Facet".
    """

    search_tolerance: float = 1e-4
    max_distance: float = 0.0
    special: bool = True
    tolerance: float = 0.01
    nodal: ClassVar[bool] = True
    side: ClassVar[type[Side]] = TiedSide

    def begin(self, state: State, groups: list[Group]) -> None:
        self.open(state)
        s, x = self.sides[0], state.x
        points = s.positions(x)
        s.closest(x, self.search_tolerance, 0.0, self.special, keep=False)
        if self.max_distance > 0.0:
            s.partner[np.linalg.norm(points - s.place, axis=1) > self.max_distance] = -1
        self.update(state, Progress())

    def bonds(self, X: Floats) -> Iterator[tuple[int, Ints, Floats, Floats]]:
        """Tied nodes at positions X, the nodes of their facets, shape functions there, and gaps (3,)."""
        s = self.side(Surface(self.primary, X), Surface(self.secondary, X), True)
        s.closest(X, self.search_tolerance, 0.0, self.special, keep=False)
        s.shapes(X)
        gap = s.positions(X) - s.place
        near = (self.max_distance <= 0.0) | (np.linalg.norm(gap, axis=1) <= self.max_distance)
        for k in np.flatnonzero((s.partner >= 0) & near):
            facet, n = s.other.conn[s.partner[k]], s.other.count[s.partner[k]]
            yield int(s.surface.nodes[k]), facet[:n], s.M[k, :n], gap[k]

    def update(self, state: State, progress: Progress) -> None:
        s, x = self.sides[0], state.x
        assert isinstance(s, TiedSide)
        s.shapes(x)
        held = (s.partner >= 0)[:, None]
        s.gap = np.where(held, s.positions(x) - s.place - s.start, 0.0)
        if s.offset.any():
            o = s.other
            contact.partner_normals(o.T, x, o.conn, o.count, s.partner, s.rs, s.partner_normals)
            s.gap -= np.where(held, s.offset[:, None] * s.partner_normals, 0.0)

    def traction(self, state: State) -> Floats:
        """L + eps g (q, 3)."""
        s = self.sides[0]
        assert isinstance(s, TiedSide)
        return np.asarray(s.multiplier + self.scale(state) * s.gap)

    def values(self, s: Side, what: str, state: State) -> Floats | None:
        assert isinstance(s, TiedSide)
        if what == "traction":
            return self.traction(state)
        return np.asarray(np.linalg.norm(s.gap, axis=1)) if what == "gap" else None

    def residual(self, state: State, R: Floats) -> None:
        s = self.sides[0]
        s.spread(state, -s.reference_area[:, None] * self.traction(state), R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        s, out = self.sides[0], []
        k = self.scale(state) * s.reference_area
        for rows, a, b, nodes in s.pairs(s.partner >= 0):
            K, unknowns, columns = matrices(state, nodes)
            contact.penalty_stiffness(rows, a, b, s.N, s.M, k, K)
            out.append((K, unknowns, columns))
        return out

    def augment(self, done: int, state: State) -> bool:
        """L += eps g; ends where the relative change of |L| is below the tolerance."""
        if not self.laugon:
            return True
        s = self.sides[0]
        assert isinstance(s, TiedSide)
        new = self.traction(state)
        n0, n1 = float(np.linalg.norm(s.multiplier)), float(np.linalg.norm(new))
        change = abs((n1 - n0) / n1) if n1 > 1e-10 else 0.0
        ended = (change < self.tolerance and done >= self.minaug) or done >= self.maxaug
        if not ended:
            s.multiplier = new
        return ended


register(TiedNode, "tied-node-on-facet")
