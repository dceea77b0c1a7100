"""Biphasic facets tied to others: displacement and fluid pressure pass from one to the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..kernels import contact, contact_flow
from . import fluid, register
from .base import Floats, Matrices, Progress, Side
from .penalty import conductance
from .tied_elastic import TiedElastic, TiedPoints

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..group import Group
    from ..state import State


class TiedFluid(TiedPoints):
    """At integration points besides: pressure difference, multiplier of the flow, and whether fluid can pass."""

    memory = (*TiedPoints.memory, "flow", "step", "conductance")

    def __init__(self, *args: object) -> None:
        super().__init__(*args)
        self.flow, self.step, self.conductance = np.zeros(self.n), np.zeros(self.n), np.ones(self.n)
        self.open = np.zeros(self.n, bool)


@dataclass(eq=False)
class TiedBiphasic(TiedElastic):
    """As :class:`~.tied_elastic.TiedElastic`, with a flow L + eps_p (p1 - p2) per current area between porous facets.

    FEBio User Manual, "Tied Biphasic".
    """

    pressure_penalty: float = 1.0
    gaptol: float = 0.0
    ptol: float = 0.0
    side: ClassVar[type[Side]] = TiedFluid

    @property
    def symmetric(self) -> bool:
        return False

    def begin(self, state: State, groups: list[Group]) -> None:
        super().begin(state, groups)
        wet: list[NDArray[np.bool_]] = [fluid.porous(s.surface, groups) for s in self.sides]
        for s, here, there in zip(self.sides, wet, reversed(wet), strict=True):
            assert isinstance(s, TiedFluid)
            s.open = fluid.both(s, here, there)
            if self.auto_penalty:
                s.conductance = conductance(s.surface, groups)[s.facet]

    def update(self, state: State, progress: Progress) -> None:
        super().update(state, progress)
        for s in self.passes:
            assert isinstance(s, TiedFluid)
            p1, p2 = fluid.pressures(s, state)
            s.step = np.where(s.open, p1 - p2, 0.0)

    def flow(self, s: Side) -> tuple[Floats, Floats]:
        """wn and eps_p (q,), zero where no fluid passes."""
        assert isinstance(s, TiedFluid)
        eps = np.where(s.open, self.pressure_penalty * s.conductance, 0.0)
        return np.where(s.open, s.flow, 0.0) + eps * s.step, eps

    def residual(self, state: State, R: Floats) -> None:
        super().residual(state, R)
        for s in self.passes:
            fluid.spread(state, s, state.dt * self.flow(s)[0] * s.detJ * s.surface.weight, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out = []
        for s in self.passes:
            k, t = self.scale(state) * s.modulus * s.detJ * s.surface.weight, self.traction(s, state)
            (wn, eps), w = self.flow(s), s.surface
            for rows, a, b, nodes in s.pairs(s.partner >= 0):
                K, unknowns, columns = fluid.unknowns(state, nodes)
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
        """As tied contact, the flow's multiplier too; pressure differences over tractions are small at the end."""
        if not self.laugon:
            return True
        steps = traction = 0.0
        worst = 0.0
        for s in self.sides:
            assert isinstance(s, TiedFluid)
            s.flow = self.flow(s)[0]
            steps += float((s.step**2).sum())
            worst = max(worst, float(np.abs(s.step).max(initial=0.0)))
            traction += float((self.traction(s, state) ** 2).sum())
        good = super().augment(done, state)
        loose = 0 < self.tolerance < steps / (traction or 1.0) or 0 < self.ptol < worst
        return (good and not loose) or done >= self.maxaug


register(TiedBiphasic, "tied-biphasic")
