"""Nearly incompressible Yeoh solid."""

from __future__ import annotations

from dataclasses import dataclass

from ..points import Points
from .base import Floats, Number
from .hyperelastic import UncoupledHyperelastic, columns
from .registry import register


@dataclass(eq=False)
class Yeoh(UncoupledHyperelastic):
    """W~ = sum_i c_i (I1~ - 3)^i; FEBio's stress takes sum_i c_i (I1~ - 3)^(i-1) for dW~/dI1~, kept here."""

    c1: Number = 0.0
    c2: Number = 0.0
    c3: Number = 0.0
    c4: Number = 0.0
    c5: Number = 0.0
    c6: Number = 0.0
    parameters = ("c1", "c2", "c3", "c4", "c5", "c6")

    def derivatives(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        x, par = I1 - 3.0, self.par(pts).T
        W1 = sum(c * x**i for i, c in enumerate(par))
        W11 = sum(i * c * x ** (i - 1) for i, c in enumerate(par) if i)
        return columns(pts, W1, 0.0, W11)

    def potential(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        x = I1 - 3.0
        return sum((c * x ** (i + 1) for i, c in enumerate(self.par(pts).T)), start=0.0 * x)


register(Yeoh, "Yeoh")
