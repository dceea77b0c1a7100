"""Rate per referential volume, for solutes that are bound to the solid."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import ReactionRate


@dataclass(eq=False)
class SoluteAsSBM(ReactionRate):
    """k = k0 / (J - phi0), phi0 the referential solid volume fraction. FEBio 4.11, "solute-as-sbm reaction rate"."""

    k0: Number = 0.0
    parameters = ("k0",)

    def rate(self, pts: Points, sol: Solution) -> Floats:
        return self.par(pts)[:, 0] / (pts.J - sol.phi0)

    def by_J(self, pts: Points, sol: Solution) -> Floats:
        return -self.par(pts)[:, 0] / (pts.J - sol.phi0) ** 2


register(SoluteAsSBM, "solute-as-sbm reaction rate")
