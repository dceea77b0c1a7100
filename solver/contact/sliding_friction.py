"""Surfaces that slide on each other with friction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..kernels import contact
from ..kernels import friction as kernels
from ..kernels import sliding_elastic as normal
from . import register
from .base import Floats, Matrices, Progress, Side, matrices
from .sliding_elastic import SlidingElastic, SlidingPoints

if TYPE_CHECKING:
    from ..state import State


class FrictionPoints(SlidingPoints):
    """At integration points besides: partners when the step began, tractions, their multipliers, directions of slip."""

    memory = (*SlidingPoints.memory, "traction_multiplier", "before", "rs_before", "sticks", "dg", "s")

    def __init__(self, *args: object) -> None:
        super().__init__(*args)
        q = self.n
        self.traction_multiplier, self.dg, self.s, self.t = (np.zeros((q, 3)) for _ in range(4))
        self.before, self.rs_before = np.full(q, -1, np.int64), np.zeros((q, 2))
        self.sticks, self.p = np.zeros(q, bool), np.zeros(q)


@dataclass(eq=False)
class SlidingFriction(SlidingElastic):
    """As :class:`~.sliding_elastic.SlidingElastic`, with Coulomb friction of coefficient ``fric_coeff``.

    Zimmerman and Ateshian, J. Biomech. Eng. 140 (2018) 081013.
    """

    fric_coeff: float = 0.0
    side: ClassVar[type[Side]] = FrictionPoints

    def __post_init__(self) -> None:
        super().__post_init__()
        self.knmult = 1  # FEBio has no other tangent with friction

    def update(self, state: State, progress: Progress) -> None:
        super().update(state, progress)
        if progress.iterations == 0:
            for s in self.passes:
                assert isinstance(s, FrictionPoints)
                s.before, s.rs_before = s.partner.copy(), s.rs.copy()

    def project(self, state: State, search: bool) -> None:
        super().project(state, search)
        for s in self.passes:
            assert isinstance(s, FrictionPoints)
            apart = s.partner < 0
            s.dg[apart] = s.traction_multiplier[apart] = 0.0

    def _tractions(self, s: FrictionPoints, state: State) -> None:
        """Who sticks, and the tractions."""
        w, o = s.surface, s.other
        before = state.X + state.u_old
        kernels.tractions(
            w.T, state.x, before, w.conn, w.count, w.facet, o.conn, o.count, s.points, s.normals, w.N, w.G, s.M, s.gap,
            self.stiffnesses(s, state), s.multiplier, s.traction_multiplier, self.fric_coeff, self.offset, s.partner,
            s.rs, s.before, s.rs_before, s.sticks, s.dg, s.s, s.p, s.t,
        )  # fmt: skip
        s.shapes(state.x)

    def pressure(self, s: Side, state: State) -> Floats:
        assert isinstance(s, FrictionPoints)
        return s.p

    def values(self, s: Side, what: str, state: State) -> Floats | None:
        assert isinstance(s, FrictionPoints)
        return s.t if what == "traction" and not self.two_pass else super().values(s, what, state)

    def residual(self, state: State, R: Floats) -> None:
        for s in self.passes:
            assert isinstance(s, FrictionPoints)
            self._tractions(s, state)
            s.spread(state, (s.detJ * s.surface.weight)[:, None] * s.t, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out = []
        for s in self.passes:
            assert isinstance(s, FrictionPoints)
            self._tractions(s, state)
            for sticking in (True, False):
                acting = (s.p != 0.0) & (s.sticks == sticking)
                for rows, a, b, nodes in s.pairs(acting):
                    K, unknowns, columns = matrices(state, nodes)
                    (self._stick if sticking else self._slip)(s, state, rows, a, b, K)
                    out.append((K, unknowns, columns))
        return out

    def _stick(self, s: FrictionPoints, state: State, rows: np.ndarray, a: int, b: int, K: Floats) -> None:
        w = s.surface
        k = self.stiffnesses(s, state) * s.detJ * w.weight
        contact.penalty_stiffness(rows, a, b, w.N, s.M, k, K)
        contact.area_stiffness(state.x, w.conn, w.facet, rows, a, b, w.N, w.G, s.M, w.weight, s.t, K)

    def _slip(self, s: FrictionPoints, state: State, rows: np.ndarray, a: int, b: int, K: Floats) -> None:
        w, o, eps = s.surface, s.other, self.stiffnesses(s, state)
        normal.stiffness(
            w.T, state.x, w.conn, w.facet, o.conn, s.partner, s.rs, rows, a, b, w.N, w.G, s.M, w.weight, s.normals,
            s.gap, eps, s.p, 1.0, K,
        )  # fmt: skip
        kernels.stiffness(
            w.T, state.x, state.X + state.u_old, w.conn, w.count, w.facet, o.conn, o.count, s.partner, s.rs,
            rows, a, b, w.N, w.G, s.M, w.weight, s.normals, s.gap, eps, s.p, self.fric_coeff, K,
        )  # fmt: skip

    def augment(self, done: int, state: State) -> bool:
        """Multipliers of tractions where points stick, of pressures where they slip; ends as without friction."""
        if not self.laugon or (self.tolerance <= 0.0 and self.gaptol <= 0.0):
            return True
        n0 = n1 = gap = 0.0
        for s in self.sides:
            assert isinstance(s, FrictionPoints)
            eps, stick = self.stiffnesses(s, state), s.sticks
            n0 += float(np.where(stick, (s.traction_multiplier**2).sum(axis=1), s.multiplier**2).sum())
            trial = s.traction_multiplier + eps[:, None] * s.dg
            slid = s.multiplier + eps * s.gap
            held = -(trial * s.normals).sum(axis=1)
            touching = np.where(stick, held, slid) > 0.0
            size = np.where(stick, np.linalg.norm(s.dg, axis=1), np.abs(s.gap))
            gap = max(gap, float(size[touching].max(initial=0.0)))
            s.multiplier = np.where(stick, held, np.maximum(slid, 0.0))
            slipping = -(s.normals + self.fric_coeff * s.s) * s.multiplier[:, None]
            s.traction_multiplier = np.where(stick[:, None], trial, slipping)
            n1 += float(np.where(stick, (s.traction_multiplier**2).sum(axis=1), s.multiplier**2).sum())
        change = abs(n1 - n0) / (n1 or 1.0)
        good = not (0 < self.gaptol < gap) and not (0 < self.tolerance < change) and done >= self.minaug
        self.project(state, True)
        return good or done >= self.maxaug


register(SlidingFriction, "sliding-elastic with friction")
