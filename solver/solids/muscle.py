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


def _shear_second(i: dict[str, Floats], G1: Floats, G2: Floats) -> tuple[Floats, ...]:
    """W11, W14, W15, W44, W45, W55 of :func:`_shear`; near w = 1 by the limits of beta and its derivative."""
    I1, I4, I5 = i["I1"], i["I4"], i["I5"]
    l = np.sqrt(I4)
    w = 0.5 * (I1 * I4 - I5) / l
    far = w > 1.0001
    safe = np.where(far, w, 2.0)
    beta = np.where(far, np.arccosh(safe) / np.sqrt(safe**2 - 1.0), 1.0)
    ksi = np.where(far, (1.0 - w * beta) / (safe**2 - 1.0), -1.0 / 3.0)  # d beta / d w
    both = I1 * I4 + I5
    W11 = 0.5 * ksi * G2 * I4
    W14 = 0.5 * G2 * beta / l + 0.25 * G2 * ksi * both / I4
    W15 = -0.5 * G2 * ksi
    W44 = 6.0 * G1 * I5 / I4**4 + 0.125 * G2 * ksi * both**2 / I4**3
    W44 -= 0.25 * G2 * beta * (I1 * I4 + 3.0 * I5) * I4**-2.5
    W45 = -2.0 * G1 / I4**3 + 0.5 * G2 * beta * I4**-1.5 - 0.25 * G2 * ksi * both / I4**2
    return W11, W14, W15, W44, W45, 0.5 * G2 * ksi / I4


def _passive_slope(x: Floats, P1: Floats, P2: Floats, top: Floats) -> Floats:
    """d/dx of :func:`_passive`."""
    return np.where(x <= 1.0, 0.0, P1 * P2 * np.exp(P2 * (np.minimum(x, top) - 1.0)))


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
    lam_max: Number = 0.0
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

    def second(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        g1, g2, g3, p1, p2, Lofl, smax, lam_max, activation = self.par(pts).T
        W11, W14, W15, W44, W45, W55 = _shear_second(i, g1, g2)
        I4 = i["I4"]
        l = np.sqrt(I4)
        x = l / Lofl
        passive, slope = _passive(x, p1, p2, lam_max / Lofl), _passive_slope(x, p1, p2, lam_max / Lofl)
        end = x - np.where(x < 1.0, 0.4, 1.6)
        middle, outside = (x > 0.6) & (x < 1.4), (x <= 0.4) | (x >= 1.6)
        active = np.where(outside, 0.0, np.where(middle, 1.0 - 4.0 * (1.0 - x) ** 2, 9.0 * end**2))
        rise = np.where(outside, 0.0, np.where(middle, 8.0 * (1.0 - x), 18.0 * end))
        force, stiffness = smax * (passive + activation * active) / Lofl, smax * (slope + activation * rise) / Lofl**2
        W44 = W44 + 9.0 / 8.0 * g3 * (1.0 - np.log(I4)) / I4**2 + 0.25 * (stiffness - force / l) / I4
        return W11, W14, W15, W44, W45, W55


@dataclass(eq=False)
class Tendon(UncoupledFourthInvariant):
    """Shear along and across the fiber and a passive fiber force-length relation."""

    g1: Number = 0.0
    g2: Number = 0.0
    l1: Number = 0.0
    l2: Number = 0.0
    lam_max: Number = 0.0
    parameters = ("g1", "g2", "l1", "l2", "lam_max")

    def derivatives(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        g1, g2, l1, l2, lam_max = self.par(pts).T
        W1, W4, W5 = _shear(i, g1, g2)
        l = np.sqrt(i["I4"])
        return W1, 0.0, W4 + 0.5 * _passive(l, l1, l2, lam_max) / l**2, W5

    def second(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        g1, g2, l1, l2, lam_max = self.par(pts).T
        W11, W14, W15, W44, W45, W55 = _shear_second(i, g1, g2)
        I4 = i["I4"]
        l = np.sqrt(I4)
        sigma, slope = _passive(l, l1, l2, lam_max), _passive_slope(l, l1, l2, lam_max)
        W44 = W44 + 0.25 * slope / (l * I4) - 0.5 * sigma / I4**2
        return W11, W14, W15, W44, W45, W55


register(Muscle, "muscle material")
register(Tendon, "tendon material")
