"""Reversible reactions by the law of mass action."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import Floats, MassAction, Reaction


@dataclass(eq=False)
class MassActionReversible(Reaction):
    """zeta = kF prod_i ca_i^vR_i - kR prod_i ca_i^vP_i over reactants and products, as in the forward reaction."""

    effective: ClassVar[bool] = False

    def _actions(self) -> tuple[MassAction, MassAction]:
        assert self.forward is not None and self.reverse is not None
        return (
            MassAction(self.forward, self.reactants, self.effective),
            MassAction(self.reverse, self.products, self.effective),
        )

    def supply(self, pts: Points, sol: Solution) -> Floats:
        a, b = self._actions()
        return a.value(pts, sol) - b.value(pts, sol)

    def by_J(self, pts: Points, sol: Solution) -> Floats:
        a, b = self._actions()
        return a.by_J(pts, sol) - b.by_J(pts, sol)

    def by_concentration(self, pts: Points, sol: Solution) -> Floats:
        a, b = self._actions()
        return a.by_concentration(pts, sol) - b.by_concentration(pts, sol)


@dataclass(eq=False)
class MassActionReversibleEffective(MassActionReversible):
    """The same by effective concentrations of the solutes."""

    effective = True


register(MassActionReversible, "mass-action-reversible")
register(MassActionReversibleEffective, "mass-action-reversible-effective")
