"""Biphasic surfaces that slide on each other with friction, from which the fluid relieves the solid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from .. import elements
from ..fields import PRESSURE
from ..kernels import contact_flow
from ..multiphasic.voigt import full
from . import register
from .base import Floats, Ints, Progress, Side
from .passage import Passage
from .sliding_biphasic import SlidingBiphasic, SlidingFluid
from .sliding_friction import FrictionPoints, SlidingFriction

if TYPE_CHECKING:
    from ..group import Group
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

    def prepare(self, state: State, groups: list[Group]) -> None:
        super().prepare(state, groups)
        self._groups = groups

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
        return load_support(s, self._groups, state, self.ambient(state)[PRESSURE.name]) if self.smooth_fls else s.p1

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


def load_support(s: Side, groups: list[Group], state: State, around: float) -> Floats:
    """-p / (n . s . n) at the points (q,), from the means of pressure and stress in the elements behind their facets.

    p is the pressure above that ``around``; 0 where no element with a stress is behind. As in FEBio the normals of a
    facet's first points count as those of its nodes, between whose values the shape functions go.
    """
    w, out, n = s.surface, np.zeros(s.n), s.normals
    for kind, rows in w.kinds:
        e, facets = elements.get(kind, w.given.rules.get(kind)), np.arange(rows.start, rows.stop)
        at = np.flatnonzero(np.isin(w.facet, facets)).reshape(len(facets), e.npoints)
        owner = w.given.owner.get(kind, np.full((len(facets), 2), -1))
        for block in np.unique(owner[:, 0][owner[:, 0] >= 0]):
            mine = owner[:, 0] == block
            stress, p = _means(groups[int(block)], owner[mine, 1], state)
            normals = n[at[mine]][:, : e.nodes]
            tn = np.einsum("fai,fij,faj->fa", normals, full(stress), normals)
            ratio = np.divide(around - p[:, None], tn, out=np.zeros_like(tn), where=tn != 0.0)
            out[at[mine]] = ratio @ e.N.T
    return out


def _means(g: Group, e: Ints, state: State) -> tuple[Floats, Floats]:
    """Stress (k, 6) and fluid pressure (k,) of elements e; no stress of shells."""
    if g.shell:
        return np.zeros((len(e), 6)), np.zeros(len(e))
    stress = g.physics.outputs["stress"](g.physics)
    assert stress is not None
    if PRESSURE.name not in g.fields:
        return stress[e].mean(axis=1), np.zeros(len(e))
    return stress[e].mean(axis=1), state.layout.scalar(state.d, PRESSURE.name)[g.conn[e]] @ g.N.mean(axis=0)


register(BiphasicFriction, "sliding-biphasic with friction")
