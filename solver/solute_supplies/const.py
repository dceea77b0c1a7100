"""Constant supply."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..points import Points
from . import register
from .base import SoluteSupply


@dataclass(eq=False)
class Const(SoluteSupply):
    """crhat = supp. FEBio User Manual, "Constant Supply"."""

    supp: Number = 0.0
    parameters = ("supp",)

    def supply(self, pts: Points, cr: Floats, bound: Floats) -> Floats:
        return self.par(pts)[:, 0]


register(Const, "supply-const")
