"""Constant rate of a membrane reaction."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import MembraneRate


@dataclass(eq=False)
class Constant(MembraneRate):
    """k. FEBio User Manual, "Membrane Reaction Rate"."""

    k: Number = 0.0
    parameters = ("k",)

    def rate(self, pts: Points, sol: Solution) -> Floats:
        return self.par(pts)[:, 0]


register(Constant, "membrane constant reaction rate")
