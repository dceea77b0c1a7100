"""Forward reactions by the law of mass action."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import Floats, MassAction, Reaction


@dataclass(eq=False)
class MassActionForward(Reaction):
    """zeta = k prod_i ca_i^vR_i over reactants: solutes by actual concentrations, solid-bound molecules.

    Ateshian & Weiss, FEBio Theory Manual, "Chemical reactions".
    """

    effective: ClassVar[bool] = False
    solutes: ClassVar[bool] = True

    def _action(self) -> MassAction:
        assert self.forward is not None
        return MassAction(self.forward, self.reactants, self.effective, self.solutes)

    def supply(self, pts: Points, sol: Solution) -> Floats:
        return self._action().value(pts, sol)

    def by_J(self, pts: Points, sol: Solution) -> Floats:
        return self._action().by_J(pts, sol)

    def by_concentration(self, pts: Points, sol: Solution) -> Floats:
        return self._action().by_concentration(pts, sol)


@dataclass(eq=False)
class MassActionForwardEffective(MassActionForward):
    """The same by effective concentrations of the solutes."""

    effective = True


register(MassActionForward, "mass-action-forward")
register(MassActionForwardEffective, "mass-action-forward-effective")
