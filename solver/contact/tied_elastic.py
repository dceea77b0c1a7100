"""Facets of one surface tied to those of another along their normals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..kernels import contact
from . import register
from .base import Contact, Floats, Matrices, Progress, Side, matrices
from .penalty import automatic

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


class TiedPoints(Side):
    """At integration points: the distance at the start and the change of it, multipliers, normals, areas."""

    memory = (*Side.memory, "multiplier", "gap", "start", "modulus")

    def __init__(self, *args: object) -> None:
        super().__init__(*args)  # type: ignore[arg-type]
        self.multiplier, self.gap, self.start = np.zeros((self.n, 3)), np.zeros((self.n, 3)), np.zeros((self.n, 3))


@dataclass(eq=False)
class TiedElastic(Contact):
    """A traction L + eps g per current area ties integration points to where their normals meet the other surface.

    g = (q - x) - (q - x)_0. FEBio User Manual, "Tied Elastic".
    """

    retraces: ClassVar[bool] = True
    auto_penalty: bool = False
    gaptol: float = -1.0
    knmult: float = 1.0
    search_tol: float = 0.01
    search_radius: float = 1.0
    symmetric_stiffness: bool = True
    side: ClassVar[type[Side]] = TiedPoints

    @property
    def symmetric(self) -> bool:
        return self.symmetric_stiffness

    def begin(self, state: State, groups: list[Group]) -> None:
        self.open(state)
        self.tie(state, groups)

    def moduli(self, s: Side, state: State, groups: list[Group]) -> Floats:
        """Moduli that the penalty multiplies (q,)."""
        return automatic(s.surface, groups)[s.facet]

    def tie(self, state: State, groups: list[Group]) -> None:
        """Find the partners of the points, and how far away they are."""
        x = state.x
        for s in self.passes:
            assert isinstance(s, TiedPoints)
            if self.auto_penalty:
                s.modulus = self.moduli(s, state, groups)
            s.frames(x)
            s.meet(x, self.search_tol, self.search_radius, absolute=True, keep=False)
            s.shapes(x)
            s.start = np.where((s.partner >= 0)[:, None], s.place - s.points, 0.0)
        self.update(state, Progress())

    def update(self, state: State, progress: Progress) -> None:
        x = state.x
        for s in self.passes:
            assert isinstance(s, TiedPoints)
            s.frames(x)
            s.shapes(x)
            s.gap = np.where((s.partner >= 0)[:, None], s.place - s.points - s.start, 0.0)

    def traction(self, s: Side, state: State) -> Floats:
        """L + eps g (q, 3)."""
        assert isinstance(s, TiedPoints)
        return np.asarray(s.multiplier + (self.scale(state) * s.modulus)[:, None] * s.gap)

    def values(self, s: Side, what: str, state: State) -> Floats | None:
        assert isinstance(s, TiedPoints)
        if what == "traction":
            return self.traction(s, state)
        return np.asarray(np.linalg.norm(s.gap, axis=1)) if what == "gap" else None

    def residual(self, state: State, R: Floats) -> None:
        for s in self.passes:
            assert isinstance(s, TiedPoints)
            s.spread(state, (s.detJ * s.surface.weight)[:, None] * self.traction(s, state), R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out = []
        for s in self.passes:
            assert isinstance(s, TiedPoints)
            k, t = self.scale(state) * s.modulus * s.detJ * s.surface.weight, self.traction(s, state)
            for rows, a, b, nodes in s.pairs(s.partner >= 0):
                K, unknowns, columns = matrices(state, nodes)
                w = s.surface
                contact.area_stiffness(state.x, w.conn, w.facet, rows, a, b, w.N, w.G, s.M, w.weight, t, K)
                if self.symmetric_stiffness:
                    K = 0.5 * (K + K.transpose(0, 2, 1))
                contact.penalty_stiffness(rows, a, b, s.N, s.M, k, K)
                out.append((K, unknowns, columns))
        return out

    def augment(self, done: int, state: State) -> bool:
        """L += eps g; ends where the relative change of |L|^2 and the largest gap are small."""
        if not self.laugon:
            return True
        n0 = n1 = gap = 0.0
        for s in self.sides:
            assert isinstance(s, TiedPoints)
            n0 += float((s.multiplier**2).sum())
            s.multiplier = self.traction(s, state)
            n1 += float((s.multiplier**2).sum())
            gap = max(gap, float(np.sqrt((s.gap**2).sum(axis=1)).max(initial=0.0)))
        change = abs(n1 - n0) / (n1 or 1.0)
        good = not (0 < self.gaptol < gap) and not (0 < self.tolerance < change) and done >= self.minaug
        return good or done >= self.maxaug


register(TiedElastic, "tied-elastic")
