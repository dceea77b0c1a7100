"""Surfaces that slide on each other, the gap measured along the normals of the primary one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..kernels import sliding_elastic as kernels
from . import register
from .base import Contact, Floats, Matrices, Progress, Side, matrices
from .penalty import automatic

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


class SlidingPoints(Side):
    """At integration points: penetration, and the multiplier of the pressure."""

    memory = (*Side.memory, "multiplier", "gap", "modulus")

    def __init__(self, *args: object) -> None:
        super().__init__(*args)  # type: ignore[arg-type]
        self.multiplier, self.gap = np.zeros(self.n), np.zeros(self.n)


@dataclass(eq=False)
class SlidingElastic(Contact):
    """A pressure p = max(L + eps g, 0) per current area along the normal of the primary surface (``two_pass``: both).

    g is the penetration where the normal of an integration point meets the other surface, within
    ``search_radius``; ``tension`` lets p be negative. FEBio User Manual, "Sliding-Elastic".
    """

    auto_penalty: bool = False
    gaptol: float = 0.0
    knmult: int = 0
    search_tol: float = 0.01
    search_radius: float = 1.0
    seg_up: int = 0
    tension: bool = False
    offset: float = 0.0
    side: ClassVar[type[Side]] = SlidingPoints

    def __post_init__(self) -> None:
        super().__post_init__()
        self._since = self._augmented = 0

    @property
    def symmetric(self) -> bool:
        return False

    def begin(self, state: State, groups: list[Group]) -> None:
        self.open(state)
        self.prepare(state, groups)
        self.update(state, Progress())

    def moduli(self, s: Side, state: State, groups: list[Group]) -> Floats:
        """Moduli that the penalty multiplies (q,)."""
        return automatic(s.surface, groups)[s.facet]

    def prepare(self, state: State, groups: list[Group]) -> None:
        """Take from the elements behind the sides what does not change."""
        if self.auto_penalty:
            for s in self.sides:
                s.modulus = self.moduli(s, state, groups)

    def _searches(self, progress: Progress) -> bool:
        """May points change their partners? Only in the first ``seg_up`` iterations after an augmentation."""
        if progress.iterations == 0:
            self._since, self._augmented = 0, progress.augmentations
        elif progress.augmentations > self._augmented:
            self._since, self._augmented = progress.iterations, progress.augmentations
        return self.seg_up == 0 or progress.iterations - self._since <= self.seg_up

    def update(self, state: State, progress: Progress) -> None:
        self.project(state, self._searches(progress))

    def project(self, state: State, search: bool) -> None:
        x = state.x
        for s in self.passes:
            assert isinstance(s, SlidingPoints)
            s.frames(x)
            s.meet(x, self.search_tol, self.search_radius, absolute=False, update=search)
            s.shapes(x)
            kernels.gaps(
                s.points, s.normals, s.place, s.partner, self.offset, self.search_radius, self.tension,
                self.stiffnesses(s, state), s.multiplier, s.gap,
            )  # fmt: skip

    def stiffnesses(self, s: Side, state: State) -> Floats:
        """eps (q,)."""
        return np.asarray(self.scale(state) * s.modulus)

    def pressure(self, s: Side, state: State) -> Floats:
        """p (q,), zero where a point has no partner."""
        assert isinstance(s, SlidingPoints)
        p = s.multiplier + self.stiffnesses(s, state) * s.gap
        return np.where(s.partner >= 0, p if self.tension else np.maximum(p, 0.0), 0.0)

    def values(self, s: Side, what: str, state: State) -> Floats | None:
        assert isinstance(s, SlidingPoints)
        if what == "gap":
            return s.gap
        p = self.net_pressure(s, state)
        return p if what == "pressure" else -p[:, None] * s.normals

    def residual(self, state: State, R: Floats) -> None:
        for s in self.passes:
            f = -self.pressure(s, state) * s.detJ * s.surface.weight
            s.spread(state, f[:, None] * s.normals, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out = []
        for s in self.passes:
            assert isinstance(s, SlidingPoints)
            p, eps, o, w = self.pressure(s, state), self.stiffnesses(s, state), s.other, s.surface
            for rows, a, b, nodes in s.pairs(p != 0.0):
                K, unknowns, columns = matrices(state, nodes)
                kernels.stiffness(
                    w.T, state.x, w.conn, w.facet, o.conn, s.partner, s.rs, rows, a, b, w.N, w.G, s.M, w.weight,
                    s.normals, s.gap, eps, p, float(self.knmult), K,
                )  # fmt: skip
                out.append((K, unknowns, columns))
        return out

    def augment(self, done: int, state: State) -> bool:
        """L = p; ends where the relative change of |L|^2 and the largest gap in contact are small."""
        if not self.laugon or (self.tolerance <= 0.0 and self.gaptol <= 0.0):
            return True
        n0 = n1 = gap = 0.0
        for s in self.sides:
            assert isinstance(s, SlidingPoints)
            n0 += float((s.multiplier**2).sum())
            new = s.multiplier + self.stiffnesses(s, state) * s.gap
            counts = (new > 0.0) | self.tension
            gap = max(gap, float(np.abs(s.gap[counts]).max(initial=0.0)))
            s.multiplier = new if self.tension else np.maximum(new, 0.0)
            n1 += float((s.multiplier**2).sum())
        change = abs(n1 - n0) / (n1 or 1.0)
        good = not (0 < self.gaptol < gap) and not (0 < self.tolerance < change) and done >= self.minaug
        self.project(state, True)
        return good or done >= self.maxaug

    def snapshot(self) -> Any:
        return super().snapshot(), self._since, self._augmented

    def restore(self, saved: Any) -> None:
        sides, self._since, self._augmented = saved
        super().restore(sides)


register(SlidingElastic, "sliding-elastic")
