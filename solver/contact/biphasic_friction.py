"""Biphasic surfaces that slide on each other with friction, from which the fluid relieves the solid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..fields import PRESSURE
from ..kernels import contact_flow
from . import register
from .base import Floats, Ints, Progress, Side
from .behind import load_support
from .passage import Passage
from .sliding_biphasic import SlidingBiphasic, SlidingFluid
from .sliding_friction import FrictionPoints, SlidingFriction

if TYPE_CHECKING:
    from ..state import State


class FluidFriction(SlidingFluid, FrictionPoints):
    """At integration points besides: ``p1``, the fluid's pressure here, or beyond where there is none here, above that
    around."""

    def __init__(self, *args: object) -> None:
        super().__init__(*args)
        self.p1 = np.zeros(self.n)


@dataclass(eq=False)
class BiphasicFriction(SlidingBiphasic, SlidingFriction):
    """As :class:`~.sliding_biphasic.SlidingBiphasic`, with the friction of :mod:`..kernels.friction`.

    Its coefficient is mu (1 - (1 - phi) f); f = p / p_n is the part of the load that the fluid bears at a point, phi
    the ``contact_frac`` of solid on solid; ``smooth_fls``: f is that of the mean stress in the elements behind the
    facets. Ateshian, J. Biomech. 42 (2009) 1163; FEBio User Manual, "Sliding-Biphasic".
    """

    contact_frac: float = 0.0
    smooth_fls: bool = False
    side: ClassVar[type[Side]] = FluidFriction

    def update(self, state: State, progress: Progress) -> None:
        super().update(state, progress)
        around = self.ambient(state)[PRESSURE.name]
        for s in self.sides:
            assert isinstance(s, FluidFriction)
            q = s.passages[0]
            here, there = q.values(s, state)
            wet = q.own[s.facet], q.beyond[s.partner]
            s.p1 = np.where(s.partner >= 0, np.select(wet, [here, there], around) - around, 0.0)

    def fluid(self, s: FrictionPoints, state: State) -> Floats:
        assert isinstance(s, FluidFriction)
        return load_support(s, self.groups, state, self.ambient(state)[PRESSURE.name]) if self.smooth_fls else s.p1

    def tractions(self, s: FrictionPoints, state: State) -> None:
        super().tractions(s, state)
        assert isinstance(s, FluidFriction)
        for q in s.passages:  # of points that stick, whose partners are those of the last step
            q.update(s, state)

    def passing(
        self, s: Side, state: State, q: Passage, flow: tuple[Floats, Floats], rows: Ints, a: int, b: int, K: Floats
    ) -> None:  # fmt: skip
        assert isinstance(s, FluidFriction)
        w = s.surface
        if s.sticks[rows[0]]:
            contact_flow.tied(state.x, w.conn, w.facet, rows, a, b, w.N, w.G, s.M, w.weight, *flow, state.dt, K)
            return
        super().passing(s, state, q, flow, rows, a, b, K)
        if q is s.passages[0]:
            # FEBio multiplies by the time step here, which changes how it converges but not to what
            drag = np.where(q.open(s), state.dt * self.fric_coeff * (1.0 - self.contact_frac), 0.0)
            contact_flow.relief(rows, a, b, w.N, s.M, (drag * s.detJ * w.weight)[:, None] * s.s, K)

    def drag(self, s: FrictionPoints) -> Floats:
        assert isinstance(s, FluidFriction)
        return self.fric_coeff * np.maximum(s.multiplier - (1.0 - self.contact_frac) * s.p1, 0.0)


register(BiphasicFriction, "sliding-biphasic with friction")
