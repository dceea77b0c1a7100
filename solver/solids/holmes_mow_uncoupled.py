"""Nearly incompressible Holmes-Mow solid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .hyperelastic import UncoupledHyperelastic, columns
from .registry import register


@dataclass(eq=False)
class HolmesMowUncoupled(UncoupledHyperelastic):
    """W~ = mu (exp[beta (I1~ - 3)] - 1) / (2 beta)."""

    mu: Number = 0.0
    beta: Number = 0.0
    parameters = ("mu", "beta")

    def derivatives(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        mu, beta = self.par(pts).T
        W1 = 0.5 * mu * np.exp(beta * (I1 - 3.0))
        return columns(pts, W1, 0.0, beta * W1)

    def potential(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        mu, beta = self.par(pts).T
        return 0.5 * mu / beta * np.expm1(beta * (I1 - 3.0))


register(HolmesMowUncoupled, "uncoupled Holmes-Mow")
