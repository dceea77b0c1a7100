"""Ligament whose lateral contraction is prescribed by a function of the fiber stretch (PRLig)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .fourth_invariant import FourthInvariant
from .registry import register


@dataclass(eq=False)
class PRLig(FourthInvariant):
    """W = c1 (exp[c2 (l - 1)^2] - 1) / (2 c2) + mu (I1 - 3 - 2 ln J) / 2 + k ln(V)^2 / 2 along the first axis.

    V = (I5 - I1 I4 + I2) / (I4^(2 (m - v0)) exp[-4 m (l - 1)]). Swedberg, Reese, Maas, Ellis & Weiss, J. Biomech.
    Eng. 136 (2014) 061009.
    """

    c1: Number = 0.0
    c2: Number = 0.0
    mu: Number = 0.0
    v0: Number = 0.0
    m: Number = 0.0
    k: Number = 0.0
    parameters = ("c1", "c2", "mu", "v0", "m", "k")
    properties = {}

    def derivatives(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        c1, c2, mu, v0, m, k = self.par(pts).T
        I1, I2, I4, I5 = i["I1"], i["I2"], i["I4"], i["I5"]
        l = np.sqrt(I4)
        q = I2 - I1 * I4 + I5
        ln = np.log(q) - 2.0 * (m - v0) * np.log(I4) + 4.0 * m * (l - 1.0)
        w = k * ln / q
        slope = -I1 + 2.0 * q * m / l - 2.0 * q * (m - v0) / I4
        W4 = 0.5 * c1 * np.exp(c2 * (l - 1.0) ** 2) * (l - 1.0) / l + w * slope
        return 0.5 * mu - I4 * w, w, W4, w, -mu / pts.J

    def energy(self, pts: Points) -> Floats:
        from .fiber import directions
        from .fourth_invariant import invariants

        within = self.inner(pts)
        i = invariants(within, directions(None, within), False)
        c1, c2, mu, v0, m, k = self.par(pts).T
        l = np.sqrt(i["I4"])
        ln = np.log(i["I2"] - i["I1"] * i["I4"] + i["I5"]) - 2 * (m - v0) * np.log(i["I4"]) + 4 * m * (l - 1)
        fiber = 0.5 * c1 / c2 * np.expm1(c2 * (l - 1) ** 2)
        return fiber + 0.5 * mu * (i["I1"] - 3) - mu * np.log(pts.J) + 0.5 * k * ln**2


register(PRLig, "PRLig")
