"""Muscle and tendon by physically based strain invariants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .fourth_invariant import UncoupledFourthInvariant
from .registry import register


def _shear(i: dict[str, Floats], G1: Floats, G2: Floats) -> tuple[Floats, Floats, Floats]:
    """W1, W4, W5 of G1 (along-fiber shear)^2 + G2 (cross-fiber shear)^2.

    Criscione, Douglas & Hunter, J. Mech. Phys. Solids 49 (2001) 871.
    """
    I1, I4, I5 = i["I1"], i["I4"], i["I5"]
    l = np.sqrt(I4)
    w = 0.5 * (I1 * I4 - I5) / l
    safe = np.where(w > 1.0001, w, 2.0)
    beta = np.where(w > 1.0001, np.arccosh(safe) / np.sqrt(safe**2 - 1.0), 1.0)
    W4 = -2.0 * G1 * I5 / I4**3 + G2 * beta * (I1 * I4 + I5) * 0.5 * I4**-1.5
    return G2 * beta * l, W4, G1 / I4**2 - G2 * beta / l


def _passive(x: Floats, P1: Floats, P2: Floats, top: Floats) -> Floats:
    """P1 (exp[P2 (x - 1)] - 1) for 1 < x < top, its tangent line beyond."""
    e = np.exp(P2 * (top - 1.0))
    line = P1 * P2 * e * (x - top) + P1 * (e - 1.0)
    curve = P1 * np.expm1(P2 * (np.minimum(x, top) - 1.0))
    return np.where(x <= 1.0, 0.0, np.where(x < top, curve, line))


@dataclass(eq=False)
class Muscle(UncoupledFourthInvariant):
    """Shear along and across the fiber, a passive and an active fiber force-length relation.

    Blemker, Pinsky & Delp, J. Biomech. 38 (2005) 657.
    """

    g1: Number = 0.0
    g2: Number = 0.0
    g3: Number = 0.0
    p1: Number = 0.0
    p2: Number = 0.0
    Lofl: Number = 1.0
    smax: Number = 0.0
    lam_max: Number = 1.0
    activation: Number = 0.0
    parameters = ("g1", "g2", "g3", "p1", "p2", "Lofl", "smax", "lam_max", "activation")

    def derivatives(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        g1, g2, g3, p1, p2, Lofl, smax, lam_max, activation = self.par(pts).T
        W1, W4, W5 = _shear(i, g1, g2)
        l = np.sqrt(i["I4"])
        x = l / Lofl
        passive = _passive(x, p1, p2, lam_max / Lofl)
        ends = 9.0 * (x - np.where(x < 1.0, 0.4, 1.6)) ** 2
        active = np.where((x <= 0.6) | (x >= 1.4), ends, 1.0 - 4.0 * (1.0 - x) ** 2)
        active = np.where((x <= 0.4) | (x >= 1.6), 0.0, active)
        fiber = 0.5 * smax * (passive + activation * active) / (Lofl * l)
        return W1, 0.0, W4 + 9.0 / 8.0 * g3 * np.log(i["I4"]) / i["I4"] + fiber, W5


@dataclass(eq=False)
class Tendon(UncoupledFourthInvariant):
    """Shear along and across the fiber and a passive fiber force-length relation."""

    g1: Number = 0.0
    g2: Number = 0.0
    l1: Number = 0.0
    l2: Number = 0.0
    lam_max: Number = 1.0
    parameters = ("g1", "g2", "l1", "l2", "lam_max")

    def derivatives(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        g1, g2, l1, l2, lam_max = self.par(pts).T
        W1, W4, W5 = _shear(i, g1, g2)
        l = np.sqrt(i["I4"])
        return W1, 0.0, W4 + 0.5 * _passive(l, l1, l2, lam_max) / l**2, W5


register(Muscle, "muscle material")
register(Tendon, "tendon material")
