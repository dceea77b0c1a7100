"""Facets of mixtures with solutes tied to others: displacement, fluid and solutes pass from one to the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..kernels import contact_flow
from . import register, solutes
from .base import Floats, Matrices, Progress, Side
from .penalty import mixture
from .tied_biphasic import TiedBiphasic

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class TiedMultiphasic(TiedBiphasic):
    """As :class:`~.tied_biphasic.TiedBiphasic`, with a flux L + eps_c (c1 - c2) of each solute that both surfaces have.

    The automatic penalty goes by the tangent of the mixture at the start. FEBio User Manual, "Tied Multiphasic".
    """

    concentration_penalty: float = 1.0
    ctol: float = 0.0
    RT: float = 1.0

    def begin(self, state: State, groups: list[Group]) -> None:
        self._passages: dict[int, solutes.Passages] = {}
        super().begin(state, groups)
        if self.auto_penalty:
            for s in self.sides:
                s.modulus = mixture(s.surface, groups, state)[s.facet]
        self._passages = {id(s): solutes.Passages(s, groups, self.auto_penalty) for s in self.sides}
        self.update(state, Progress())

    def update(self, state: State, progress: Progress) -> None:
        super().update(state, progress)
        for s in self.passes if self._passages else ():
            self._passages[id(s)].update(state, s.partner >= 0)

    def residual(self, state: State, R: Floats) -> None:
        super().residual(state, R)
        for s in self.passes:
            self._passages[id(s)].residual(state, self.concentration_penalty, s.partner >= 0, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        out = super().stiffness(state)
        for s in self.passes:

            def fill(p: Any, jn: Floats, eps: Floats, rows: Any, a: int, b: int, K: Floats, s: Side = s) -> None:
                w, u = s.surface, 3 * (a + b)
                contact_flow.tied(
                    state.x, w.conn, w.facet, rows, a, b, w.N, w.G, s.M, w.weight, jn, eps, state.dt, K
                )  # fmt: skip
                K[:, u:, :u] *= eps[rows][:, None, None]  # as FEBio 4.11 has it

            on = s.partner >= 0
            out += self._passages[id(s)].stiffness(state, self.concentration_penalty, on, on, fill)
        return out

    def augment(self, done: int, state: State) -> bool:
        if not self.laugon:
            return True
        steps = [self._passages[id(s)].augment(self.concentration_penalty, s.partner >= 0) for s in self.sides]
        good = super().augment(done, state)
        traction = sum(float((self.traction(s, state) ** 2).sum()) for s in self.sides)
        good = good and solutes.settled(steps, traction, self.RT, self.tolerance, self.ctol)
        return good or done >= self.maxaug

    def snapshot(self) -> Any:
        return super().snapshot(), [self._passages[id(s)].snapshot() for s in self.sides]

    def restore(self, saved: Any) -> None:
        super().restore(saved[0])
        for s, q in zip(self.sides, saved[1], strict=True):
            self._passages[id(s)].restore(q)


register(TiedMultiphasic, "tied-multiphasic")
