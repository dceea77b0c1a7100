"""Receptors of the solid that bind the solute."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ..law import Floats, Number
from ..points import Points
from . import register
from .base import SoluteSupply


@dataclass(eq=False)
class Binding(SoluteSupply):
    """crhat = -(kf cr (Rtot - bound) - kr bound), and what is bound grows by as much.

    At rest bound = Rtot cr / (kr / kf + cr). FEBio User Manual, "Supply binding".
    """

    kf: Number = 0.0
    kr: Number = 0.0
    Rtot: Number = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("kf", "kr", "Rtot")

    def supply(self, pts: Points, cr: Floats, bound: Floats) -> Floats:
        return -Binding.binding(self, pts, cr, bound)

    def binding(self, pts: Points, cr: Floats, bound: Floats) -> Floats:
        kf, kr, total = self.par(pts)[:, :3].T
        return kf * cr * (total - bound) - kr * bound

    def bound_at_rest(self, pts: Points, cr: Floats) -> Floats:
        kf, kr, total = self.par(pts)[:, :3].T
        return total * cr / (kr / kf + cr)


register(Binding, "supply-binding")
