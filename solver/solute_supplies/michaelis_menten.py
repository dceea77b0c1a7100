"""Consumption of the solute by an enzyme."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..points import Points
from . import register
from .base import SoluteSupply


@dataclass(eq=False)
class MichaelisMenten(SoluteSupply):
    """crhat = -Vmax cr / (Km + cr). FEBio User Manual, "Michaelis-Menten"."""

    Vmax: Number = 0.0
    Km: Number = 0.0
    parameters = ("Vmax", "Km")

    def supply(self, pts: Points, cr: Floats, bound: Floats) -> Floats:
        Vmax, Km = self.par(pts).T
        return -Vmax * cr / (Km + cr)


register(MichaelisMenten, "supply-Michaelis-Menten")
