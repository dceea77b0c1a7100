"""Neo-Hookean solid with five constants of transverse isotropy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .fiber import directions
from .fourth_invariant import FourthInvariant, invariants
from .registry import register


@dataclass(eq=False)
class TransIsoNeoHookean(FourthInvariant):
    """W = G (I1 - 3)/2 - G ln J + lp (J - 1)^2/2 + a (I1 - 3)(I4 - 1)/4 + (gz - G)(I5 - I4^2)/2
    + gz (I4 - 1 - ln I4)/2 + lz (I4^1/2 - 1)^2/2 along the first material axis; G = Ep / (2 (1 + vp)).

    Ep, vp across and Ez, vz along the axis, gz the shear modulus; lp, lz, a make the small-strain moduli these.
    """

    Ep: Number = 0.0
    Ez: Number = 0.0
    vz: Number = 0.0
    vp: Number = 0.0
    gz: Number = 0.0
    parameters = ("Ep", "Ez", "vz", "vp", "gz")
    properties = {}

    def _moduli(self, pts: Points) -> tuple[Floats, ...]:
        """G, gz, lp, lz, a."""
        Ep, Ez, vz, vp, gz = self.par(pts).T
        G = Ep / (2.0 * (1.0 + vp))
        d = (1.0 + vp) * (Ez * (vp - 1.0) + 2.0 * Ep * vz**2)
        lp = -Ep * (Ez * vp + Ep * vz**2) / d
        lz = Ez**2 * (vp**2 - 1.0) - Ep * (Ep + 4.0 * (G + gz) * (1.0 + vp)) * vz**2
        lz += Ez * (2.0 * (gz + G) * (1.0 - vp**2) - Ep * vp + 2.0 * Ep * vz * (1.0 + vp))
        return G, gz, lp, lz / d, Ep * (Ep * vz**2 - Ez * (vp * (vz - 1.0) + vz)) / d

    def derivatives(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        G, gz, lp, lz, a = self._moduli(pts)
        I1, I4 = i["I1"], i["I4"]
        W4 = 0.25 * a * (I1 - 3.0) - (gz - G) * I4 + 0.5 * gz * (1.0 - 1.0 / I4) + 0.5 * lz * (1.0 - I4**-0.5)
        return 0.5 * G + 0.25 * a * (I4 - 1.0), 0.0, W4, 0.5 * (gz - G), lp * (pts.J - 1.0) - G / pts.J

    def energy(self, pts: Points) -> Floats:
        within = self.inner(pts)
        i, (G, gz, lp, lz, a) = invariants(within, directions(None, within), False), self._moduli(pts)
        I1, I4, I5 = i["I1"] - 3.0, i["I4"], i["I5"]
        matrix = 0.5 * G * I1 - G * np.log(pts.J) + 0.5 * lp * (pts.J - 1.0) ** 2 + 0.25 * a * I1 * (I4 - 1.0)
        fiber = 0.5 * (gz - G) * (I5 - I4**2) + 0.5 * gz * (I4 - 1.0 - np.log(I4)) + 0.5 * lz * (np.sqrt(I4) - 1.0) ** 2
        return matrix + fiber


register(TransIsoNeoHookean, "neo-Hookean transiso")
