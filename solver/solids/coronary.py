"""Coronary arteries: an exponential of the first and the fourth invariant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .fiber import directions
from .fourth_invariant import UncoupledFourthInvariant, invariants
from .registry import register


@dataclass(eq=False)
class Coronary(UncoupledFourthInvariant):
    """W~ = k1/k2 (exp[k2 w] - 1), w = (1 - rho) (I1~ - 3)^2 + rho (I4~ - 1)^2.

    Holzapfel et al., Am. J. Physiol. Heart Circ. Physiol. 289 (2005) H2048.
    """

    rho: Number = 0.0
    k1: Number = 0.0
    k2: Number = 1.0
    parameters = ("rho", "k1", "k2")

    def _exponent(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats, ...]:
        """k1/k2 exp(w), its first derivatives w1, w4 and second w11, w44; here w holds k2."""
        rho, k1, k2 = self.par(pts).T
        x, y, a, b = i["I1"] - 3.0, i["I4"] - 1.0, k2 * (1.0 - rho), k2 * rho
        return k1 / k2 * np.exp(a * x * x + b * y * y), 2.0 * a * x, 2.0 * b * y, 2.0 * a, 2.0 * b

    def derivatives(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        e, w1, w4, _, _ = self._exponent(pts, i)
        return e * w1, 0.0, e * w4, 0.0

    def second(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        e, w1, w4, w11, w44 = self._exponent(pts, i)
        return e * (w1 * w1 + w11), e * w1 * w4, 0.0, e * (w4 * w4 + w44), 0.0, 0.0

    def dev_energy(self, pts: Points) -> Floats:
        _, k1, k2 = self.par(pts).T
        within = self.inner(pts)
        return self._exponent(pts, invariants(within, directions(self.fiber, within), True))[0] - k1 / k2


register(Coronary, "HGO-coronary")
