"""Compressible Veronda-Westmann solid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .hyperelastic import Hyperelastic, columns
from .registry import register


@dataclass(eq=False)
class CoupledVerondaWestmann(Hyperelastic):
    """W = c1 (exp[c2 (I1 - 3)] - 1) - c1 c2 (I2 - 3) / 2 + k (ln J)^2 / 2."""

    c1: Number = 0.0
    c2: Number = 0.0
    k: Number = 0.0
    parameters = ("c1", "c2", "k")

    def derivatives(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        c1, c2, k = self.par(pts).T
        W1 = c1 * c2 * np.exp(c2 * (I1 - 3.0))
        lnJ = np.log(J)
        return columns(pts, W1, -0.5 * c1 * c2, c2 * W1, 0.0, 0.0, k * lnJ / J, k * (1.0 - lnJ) / J**2)

    def potential(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        c1, c2, k = self.par(pts).T
        return c1 * np.expm1(c2 * (I1 - 3.0)) - 0.5 * c1 * c2 * (I2 - 3.0) + 0.5 * k * np.log(J) ** 2


register(CoupledVerondaWestmann, "coupled Veronda-Westmann")
