"""Surfaces of mixtures with solutes that slide on each other: fluid and solutes pass where they touch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..kernels import contact_flow
from . import register, solutes
from .base import Floats, Matrices, Progress, Side
from .sliding_biphasic import SlidingBiphasic

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class SlidingMultiphasic(SlidingBiphasic):
    """As :class:`~.sliding_biphasic.SlidingBiphasic`, with a flux L + eps_c (c1 - c2) of each solute of both surfaces.

    Where they do not touch, nodes have the ambient pressure and concentrations: ``ambient``, by nodal field.
    FEBio User Manual, "Sliding-Biphasic-Solute", "Sliding-Multiphasic".
    """

    concentration_penalty: float = 1.0
    ctol: float = 0.0
    RT: float = 1.0

    def begin(self, state: State, groups: list[Group]) -> None:
        self._passages: dict[int, solutes.Passages] = {}
        super().begin(state, groups)
        self._passages = {id(s): solutes.Passages(s, groups, self.auto_penalty) for s in self.sides}
        self.update(state, Progress())

    def update(self, state: State, progress: Progress) -> None:
        super().update(state, progress)
        for s in self.sides if self._passages else ():
            self._passages[id(s)].update(state, s.partner >= 0)

    def residual(self, state: State, R: Floats) -> None:
        super().residual(state, R)
        for s in self.passes:
            on = self.pressure(s, state) > 0.0
            self._passages[id(s)].residual(state, self.concentration_penalty, on, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out = super().stiffness(state)
        for s in self.passes:

            def fill(p: Any, jn: Floats, eps: Floats, rows: Any, a: int, b: int, K: Floats, s: Side = s) -> None:
                w, o = s.surface, s.other
                c = np.ascontiguousarray(state.layout.scalar(state.d, p.field))
                contact_flow.sliding(
                    w.T, state.x, c, w.conn, w.facet, o.conn, s.partner, s.rs, rows, a, b, w.N, w.G, s.M, w.weight,
                    s.normals, s.gap, jn, eps, state.dt, K,  # type: ignore[attr-defined]
                )  # fmt: skip

            p = self.pressure(s, state)
            out += self._passages[id(s)].stiffness(state, self.concentration_penalty, p > 0.0, p != 0.0, fill)
        return out

    def augment(self, done: int, state: State) -> bool:
        if not self.laugon:
            return True
        touching = [s.multiplier + self.stiffnesses(s, state) * s.gap > 0.0 for s in self.sides]  # type: ignore[attr-defined]
        steps = [
            self._passages[id(s)].augment(self.concentration_penalty, on) for s, on in zip(self.sides, touching)
        ]
        good = super().augment(done, state)
        traction = sum(float((self.pressure(s, state) ** 2).sum()) for s in self.sides)
        good = good and solutes.settled(steps, traction, self.RT, self.tolerance, self.ctol)
        return good or done >= self.maxaug

    def snapshot(self) -> Any:
        return super().snapshot(), [self._passages[id(s)].snapshot() for s in self.sides]

    def restore(self, saved: Any) -> None:
        super().restore(saved[0])
        for s, q in zip(self.sides, saved[1], strict=True):
            self._passages[id(s)].restore(q)


register(SlidingMultiphasic, "sliding-multiphasic", "sliding-biphasic-solute")
