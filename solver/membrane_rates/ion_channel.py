"""Rate of passage through an ion channel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import OfOneSolute

NEAR = 1e-4  # relative difference of concentrations below which series are taken


@dataclass(eq=False)
class IonChannel(OfOneSolute):
    """k = R T g / ((z Fc)^2 s) ln(c_i / c_e) / (c_i - c_e), 0 where either is not positive.

    g: conductance, of ion ``sol`` (its place in the model) of charge number z; s: areal concentration of channels, the
    solid-bound molecule ``sbm`` (its place in the material; -1: s = 1).
    FEBio User Manual, "Membrane Ion Channel Reaction Rate".
    """

    g: Number = 0.0
    sol: int = 0
    sbm: int = -1
    z: float = 1.0
    RT: float = 0.0
    Fc: float = 1.0
    parameters = ("g",)
    needed = ("sol",)

    def _weight(self, pts: Points, sol: Solution) -> Floats:
        weight: Floats = self.RT * self.par(pts)[:, 0] / (self.z * self.Fc) ** 2
        return weight if self.sbm < 0 else weight / sol.areal_concentration(pts.J)[:, self.sbm]

    def _logarithms(self, sol: Solution) -> tuple[Floats, Floats, Floats]:
        """f = ln(c_i / c_e) / (c_i - c_e) and its derivatives by c_e and c_i (n,)."""
        e, i = self.of(sol, self.sol)
        both = (e > 0.0) & (i > 0.0)
        e, i = np.where(both, e, 1.0), np.where(both, i, 1.0)
        d, mean = i - e, 0.5 * (i + e)
        near = np.abs(d) < NEAR * mean
        apart = np.where(near, 1.0, d)
        log = np.log(i / e)
        r = d / mean  # f = 2 artanh(r / 2) / d = (1 + r^2 / 12 + ...) / mean
        f = np.where(near, (1.0 + r * r / 12.0) / mean, log / apart)
        by_mean, by_d = -1.0 / mean**2, d / (6.0 * mean**3)
        by_e = np.where(near, 0.5 * by_mean - by_d, (log / apart - 1.0 / e) / apart)
        by_i = np.where(near, 0.5 * by_mean + by_d, (1.0 / i - log / apart) / apart)
        return np.where(both, f, 0.0), np.where(both, by_e, 0.0), np.where(both, by_i, 0.0)

    def rate(self, pts: Points, sol: Solution) -> Floats:
        return self._weight(pts, sol) * self._logarithms(sol)[0]

    def by_sides(self, pts: Points, sol: Solution) -> Floats:
        weight, (_, e, i) = self._weight(pts, sol), self._logarithms(sol)
        return self.spread(sol, self.sol, weight * e, weight * i)

    def by_strain(self, pts: Points, sol: Solution) -> Floats | None:
        """Channels thin out as the membrane is stretched."""
        assert sol.sides is not None
        return None if self.sbm < 0 else self.rate(pts, sol) / sol.sides.strain


register(IonChannel, "membrane ion channel reaction rate")
