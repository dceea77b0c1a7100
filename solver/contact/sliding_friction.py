"""Surfaces that slide on each other with friction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..kernels import contact
from ..kernels import friction as kernels
from . import register
from .base import Floats, Ints, Progress, Side
from .sliding_elastic import SlidingElastic, SlidingPoints, Tangent

if TYPE_CHECKING:
    from ..state import State


class FrictionPoints(SlidingPoints):
    """At integration points besides: partners when the step began, tractions, their multipliers, directions of slip,
    coefficients of friction."""

    memory = (*SlidingPoints.memory, "traction_multiplier", "before", "rs_before", "sticks", "dg", "s")

    def __init__(self, *args: object) -> None:
        super().__init__(*args)
        q = self.n
        self.traction_multiplier, self.dg, self.s, self.t = (np.zeros((q, 3)) for _ in range(4))
        self.before, self.rs_before = np.full(q, -1, np.int64), np.zeros((q, 2))
        self.sticks, self.p, self.m = np.zeros(q, bool), np.zeros(q), np.zeros(q)


@dataclass(eq=False)
class SlidingFriction(SlidingElastic):
    """As :class:`~.sliding_elastic.SlidingElastic`, with Coulomb friction of coefficient ``fric_coeff``.

    Zimmerman and Ateshian, J. Biomech. Eng. 140 (2018) 081013.
    """

    retraces: ClassVar[bool] = False  # where points were before is asked in the first iteration
    fric_coeff: float = 0.0
    side: ClassVar[type[Side]] = FrictionPoints
    contact_frac = 1.0  # the fluid bears nothing
    smooth_fls = False

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
        for s in self.projected:
            assert isinstance(s, FrictionPoints)
            apart = s.partner < 0
            s.dg[apart] = s.traction_multiplier[apart] = 0.0

    def fluid(self, s: FrictionPoints, state: State) -> Floats:
        """Pressure of the fluid (q,), or the part of the load that it bears where ``smooth_fls``."""
        return np.zeros(s.n)

    def tractions(self, s: FrictionPoints, state: State) -> None:
        """Who sticks, and the tractions."""
        w, o = s.surface, s.other
        before = state.X + state.u_old
        kernels.tractions(
            w.T, state.x, before, w.conn, w.count, w.facet, o.conn, o.count, s.points, s.normals, w.N, w.G, s.M, s.gap,
            self.stiffnesses(s, state), s.multiplier, s.traction_multiplier, self.fric_coeff, 1.0 - self.contact_frac,
            self.fluid(s, state), self.smooth_fls, self.offset, s.partner, s.rs, s.before, s.rs_before, s.sticks, s.dg,
            s.s, s.m, s.p, s.t,
        )  # fmt: skip
        s.shapes(state.x)

    def pressure(self, s: Side, state: State) -> Floats:
        assert isinstance(s, FrictionPoints)
        return s.p

    def trial(self, s: Side, state: State) -> Floats:
        """L + eps g where points slip, minus the normal part of L + eps dg where they stick."""
        assert isinstance(s, FrictionPoints)
        held = s.traction_multiplier + self.stiffnesses(s, state)[:, None] * s.dg
        return np.where(s.sticks, -(held * s.normals).sum(axis=1), super().trial(s, state))

    def bearing(self, s: Side, state: State) -> Floats:
        """The pressure by who stuck in the last residual, as FEBio has it."""
        assert isinstance(s, FrictionPoints)
        p = self.trial(s, state)
        return np.where(s.sticks, p, np.maximum(p, 0.0))

    def values(self, s: Side, what: str, state: State) -> Floats | None:
        assert isinstance(s, FrictionPoints)
        return s.t if what == "traction" and not self.two_pass else super().values(s, what, state)

    def residual(self, state: State, R: Floats) -> None:
        for s in self.passes:
            assert isinstance(s, FrictionPoints)
            self.tractions(s, state)
            s.spread(state, (s.detJ * s.surface.weight)[:, None] * s.t, R)

    def tangents(self, s: Side, state: State) -> list[tuple[NDArray[np.bool_], Tangent]]:
        assert isinstance(s, FrictionPoints)
        self.tractions(s, state)
        acts = s.p != 0.0
        return [(acts & s.sticks, self.sticking), (acts & ~s.sticks, self.slipping)]

    def sticking(self, s: Side, state: State, rows: Ints, a: int, b: int, K: Floats) -> None:
        """Add the tangents of points that stick."""
        assert isinstance(s, FrictionPoints)
        w = s.surface
        k = self.stiffnesses(s, state) * s.detJ * w.weight
        contact.penalty_stiffness(rows, a, b, w.N, s.M, k, K)
        contact.area_stiffness(state.x, w.conn, w.facet, rows, a, b, w.N, w.G, s.M, w.weight, s.t, K)

    def slipping(self, s: Side, state: State, rows: Ints, a: int, b: int, K: Floats) -> None:
        """Add the tangents of points that slip."""
        assert isinstance(s, FrictionPoints)
        self.sliding(s, state, rows, a, b, K)
        w, o = s.surface, s.other
        kernels.stiffness(
            w.T, state.x, state.X + state.u_old, w.conn, w.count, w.facet, o.conn, o.count, s.partner, s.rs,
            rows, a, b, w.N, w.G, s.M, w.weight, s.normals, s.gap, self.stiffnesses(s, state), s.p, self.fric_coeff,
            s.m, K,
        )  # fmt: skip

    def renew(self, state: State) -> tuple[float, float, float]:
        """Multipliers of tractions where points stick, of pressures where they slip."""
        n0 = n1 = gap = 0.0
        for s in self.sides:
            assert isinstance(s, FrictionPoints)
            stick, new = s.sticks, self.renewed(s, state)
            if self.smooth_aug:
                held = self.behind(s)
            else:
                held = s.traction_multiplier + self.stiffnesses(s, state)[:, None] * s.dg
            n0 += float(np.where(stick, (s.traction_multiplier**2).sum(axis=1), s.multiplier**2).sum())
            size = np.where(stick, np.linalg.norm(s.dg, axis=1), np.abs(s.gap))
            gap = max(gap, float(size[new > 0.0].max(initial=0.0)))
            s.multiplier = np.where(stick, new, np.maximum(new, 0.0))
            slipping = -(s.normals * s.multiplier[:, None] + s.s * self.drag(s)[:, None])
            s.traction_multiplier = np.where(stick[:, None], held, slipping)
            n1 += float(np.where(stick, (s.traction_multiplier**2).sum(axis=1), s.multiplier**2).sum())
        return n0, n1, gap

    def drag(self, s: FrictionPoints) -> Floats:
        """Tractions (q,) along the surface under the multipliers of the pressure."""
        return self.fric_coeff * s.multiplier


register(SlidingFriction, "sliding-elastic with friction")
