"""Nearly incompressible neo-Hookean solid."""

from __future__ import annotations

from dataclasses import dataclass

from ..points import Points
from .base import Floats, Number
from .hyperelastic import UncoupledHyperelastic, columns
from .registry import register


@dataclass(eq=False)
class IncompressibleNeoHookean(UncoupledHyperelastic):
    """W~ = G (I1~ - 3) / 2."""

    G: Number = 0.0
    parameters = ("G",)

    def derivatives(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        return columns(pts, 0.5 * self.par(pts)[:, 0])

    def potential(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        return 0.5 * self.par(pts)[:, 0] * (I1 - 3.0)


register(IncompressibleNeoHookean, "incomp neo-Hookean")
