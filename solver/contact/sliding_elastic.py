"""Surfaces that slide on each other, the gap measured along the normals of the primary one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..kernels import sliding_elastic as kernels
from . import register
from .base import Contact, Floats, Ints, Matrices, Progress, Side, matrices
from .penalty import automatic

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State

# (side, state, points of one kind of pair, numbers of nodes, matrices)
Tangent = Callable[["Side", "State", Ints, int, int, Floats], None]


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
    ``search_radius``; ``tension`` lets p be negative; ``smooth_aug``: the multipliers L are tractions of the stress in
    the elements behind. FEBio User Manual, "Sliding-Elastic".
    """

    retraces: ClassVar[bool] = True
    auto_penalty: bool = False
    gaptol: float = 0.0
    knmult: int = 0
    search_tol: float = 0.01
    search_radius: float = 1.0
    seg_up: int = 0
    tension: bool = False
    offset: float = 0.0
    smooth_aug: bool = False
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
        self.groups = groups
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
        for s in self.projected:
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
        p = self.trial(s, state)
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
            for acting, tangent in self.tangents(s, state):
                for rows, a, b, nodes in s.pairs(acting):
                    K, unknowns, columns = matrices(state, nodes)
                    tangent(s, state, rows, a, b, K)
                    out.append((K, unknowns, columns))
        return out

    def tangents(self, s: Side, state: State) -> list[tuple[NDArray[np.bool_], Tangent]]:
        """Points (q,) of a kind, and what adds their tangents to matrices of displacements."""
        return [(self.pressure(s, state) != 0.0, self.sliding)]

    def sliding(self, s: Side, state: State, rows: Ints, a: int, b: int, K: Floats) -> None:
        """Add the tangents of points that slide without friction."""
        assert isinstance(s, SlidingPoints)
        o, w = s.other, s.surface
        kernels.stiffness(
            w.T, state.x, w.conn, w.facet, o.conn, s.partner, s.rs, rows, a, b, w.N, w.G, s.M, w.weight, s.normals,
            s.gap, self.stiffnesses(s, state), self.pressure(s, state), float(self.knmult), K,
        )  # fmt: skip

    def augment(self, done: int, state: State) -> bool:
        """L = p; ends where the relative change of |L|^2 and the largest gap in contact are small."""
        if not self.laugon or (self.tolerance <= 0.0 and self.gaptol <= 0.0):
            return True
        return self.settled(done, *self.renew(state), state)

    def settled(self, done: int, before: float, after: float, gap: float, state: State) -> bool:
        """Have the multipliers converged, whose squares were ``before``? The surfaces are projected anew."""
        change = abs(after - before) / (after or 1.0)
        good = not (0 < self.gaptol < gap) and not (0 < self.tolerance < change) and done >= self.minaug
        self.project(state, True)
        return good or done >= self.maxaug

    def renew(self, state: State) -> tuple[float, float, float]:
        """New multipliers; sums of their squares before and after, and the largest gap in contact."""
        n0 = n1 = gap = 0.0
        for s in self.sides:
            assert isinstance(s, SlidingPoints)
            n0 += float((s.multiplier**2).sum())
            new = self.renewed(s, state)
            counts = (new > 0.0) | self.tension
            gap = max(gap, float(np.abs(s.gap[counts]).max(initial=0.0)))
            s.multiplier = new if self.tension else np.maximum(new, 0.0)
            n1 += float((s.multiplier**2).sum())
        return n0, n1, gap

    def renewed(self, s: Side, state: State) -> Floats:
        """The next multipliers of the pressure (q,), where it is one."""
        return -(self.behind(s) * s.normals).sum(axis=1) if self.smooth_aug else self.trial(s, state)

    def behind(self, s: Side) -> Floats:
        """Tractions of the stress behind a side (q, 3), or its share of two passes; none where it is not projected."""
        from .behind import tractions

        if s not in self.projected:
            return np.zeros((s.n, 3))
        return tractions(s, self.groups) * (0.5 if self.two_pass else 1.0)

    @property
    def projected(self) -> list[Side]:
        """The sides that are projected on the others."""
        return self.passes

    def trial(self, s: Side, state: State) -> Floats:
        """L + eps g (q,)."""
        assert isinstance(s, SlidingPoints)
        return np.asarray(s.multiplier + self.stiffnesses(s, state) * s.gap)

    def snapshot(self) -> Any:
        return super().snapshot(), self._since, self._augmented

    def restore(self, saved: Any) -> None:
        sides, self._since, self._augmented = saved
        super().restore(sides)


register(SlidingElastic, "sliding-elastic")
