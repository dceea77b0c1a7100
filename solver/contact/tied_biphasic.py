"""Biphasic facets tied to others: displacement and fluid pressure pass from one to the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..fields import PRESSURE
from ..kernels import contact, contact_flow
from . import register
from .base import Floats, Matrices, Progress, Side
from .passage import Passage, Passages, Steps, holds
from .penalty import conductance
from .tied_elastic import TiedElastic, TiedPoints

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


class TiedFluid(TiedPoints):
    """At integration points besides: what passes."""

    def __init__(self, *args: object) -> None:
        super().__init__(*args)
        self.passages = Passages()

    def snapshot(self) -> dict[str, Any]:
        return super().snapshot() | {"passages": self.passages.snapshot()}

    def restore(self, saved: dict[str, Any]) -> None:
        own = dict(saved)
        self.passages.restore(own.pop("passages"))
        super().restore(own)


@dataclass(eq=False)
class TiedBiphasic(TiedElastic):
    """As :class:`~.tied_elastic.TiedElastic`, with a flow L + eps_p (p1 - p2) per current area between porous facets.

    FEBio User Manual, "Tied Biphasic".
    """

    pressure_penalty: float = 1.0
    gaptol: float = 0.0
    ptol: float = 0.0
    side: ClassVar[type[Side]] = TiedFluid
    ctol = 0.0
    RT = 1.0

    @property
    def symmetric(self) -> bool:
        return False

    def begin(self, state: State, groups: list[Group]) -> None:
        self.open(state)
        for s, o in (self.sides, reversed(self.sides)):
            assert isinstance(s, TiedFluid)
            for field, penalty in self.carried(groups):
                own, beyond = (holds(q.surface, groups, field) for q in (s, o))
                k = self.conductances(s, field, groups)
                s.passages.append(Passage(field, penalty, own, beyond, k))
        self.tie(state, groups)

    def carried(self, groups: list[Group]) -> list[tuple[str, float]]:
        """Fields that pass, and their penalties."""
        return [(PRESSURE.name, self.pressure_penalty)]

    def conductances(self, s: Side, field: str, groups: list[Group]) -> Floats:
        """What the penalty of a field multiplies (q,)."""
        return conductance(s.surface, groups, field)[s.facet] if self.auto_penalty else np.ones(s.n)

    def update(self, state: State, progress: Progress) -> None:
        super().update(state, progress)
        for s in self.passes:
            assert isinstance(s, TiedFluid)
            for q in s.passages:
                q.update(s, state)

    def residual(self, state: State, R: Floats) -> None:
        super().residual(state, R)
        for s in self.passes:
            assert isinstance(s, TiedFluid)
            for q in s.passages:
                q.spread(s, state, state.dt * q.flow(s)[0] * s.detJ * s.surface.weight, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out = []
        for s in self.passes:
            assert isinstance(s, TiedFluid)
            k, t = self.scale(state) * s.modulus * s.detJ * s.surface.weight, self.traction(s, state)
            w, flows = s.surface, [q.flow(s) for q in s.passages]
            for rows, a, b, nodes in s.pairs(s.partner >= 0):
                for i, (q, (wn, eps)) in enumerate(zip(s.passages, flows, strict=True)):
                    K, unknowns, columns = q.unknowns(state, nodes)
                    if i == 0:
                        contact.area_stiffness(state.x, w.conn, w.facet, rows, a, b, w.N, w.G, s.M, w.weight, t, K)
                        if self.symmetric_stiffness:
                            K = 0.5 * (K + K.transpose(0, 2, 1))
                        contact.penalty_stiffness(rows, a, b, s.N, s.M, k, K)
                    contact_flow.tied(
                        state.x, w.conn, w.facet, rows, a, b, w.N, w.G, s.M, w.weight, wn, eps, state.dt, K
                    )  # fmt: skip
                    out.append((K, unknowns, columns))
        return out

    def augment(self, done: int, state: State) -> bool:
        """As tied contact, the flows' multipliers too; differences over tractions are small at the end."""
        if not self.laugon:
            return True
        steps, traction = Steps(), 0.0
        for s in self.sides:
            assert isinstance(s, TiedFluid)
            for q in s.passages:
                q.multiplier = q.flow(s)[0]
                steps.add(q)
            traction += float((self.traction(s, state) ** 2).sum())
        good = super().augment(done, state)
        loose = steps.loose(traction, self.tolerance, self.ptol, self.ctol, self.RT)
        return (good and not loose) or done >= self.maxaug


register(TiedBiphasic, "tied-biphasic")
