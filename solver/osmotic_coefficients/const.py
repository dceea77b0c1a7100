"""Constant osmotic coefficient."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import OsmoticCoefficient


@dataclass(eq=False)
class Const(OsmoticCoefficient):
    """Phi = osmcoef. FEBio User Manual, "Constant Osmotic Coefficient"."""

    osmcoef: Number = 1.0
    parameters = ("osmcoef",)

    def coefficient(self, pts: Points, sol: Solution) -> Floats:
        return self.par(pts)[:, 0]


register(Const, "osm-coef-const")
