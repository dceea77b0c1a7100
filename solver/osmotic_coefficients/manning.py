"""Osmotic coefficient by Manning's counterion condensation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats, Number
from ..multiphasic.manning import Function, ratio
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import OsmoticCoefficient


@dataclass(eq=False)
class Manning(OsmoticCoefficient):
    """Phi = M(X) + osmc(ca) - 1, X = |cF| / ca of the co-ion (its index in the material).

    M = 1 - ksi X / (2 (X + 2)) where ksi <= 1, else (X / (2 ksi) + 2) / (X + 2); ``osmc`` is Wells' coefficient as a
    function of the co-ion's concentration. Manning, J. Chem. Phys. 51 (1969) 924; FEBio User Manual.
    """

    osmc: Function
    co_ion: int = 0
    ksi: Number = 1.0
    parameters = ("ksi",)
    needed = ("osmc", "co_ion")

    def coefficient(self, pts: Points, sol: Solution) -> Floats:
        r, ksi = ratio(pts, sol, self.co_ion), self.par(pts)[:, 0]
        low, high = 1.0 - 0.5 * ksi * r.X / (r.X + 2.0), (0.5 * r.X / ksi + 2.0) / (r.X + 2.0)
        return np.where(ksi <= 1.0, low, high) + self.osmc.value(r.ca) - 1.0

    def slopes(self, pts: Points, sol: Solution) -> tuple[Floats, Floats]:
        r, ksi = ratio(pts, sol, self.co_ion), self.par(pts)[:, 0]
        dX = np.where(ksi <= 1.0, -ksi, 1.0 / ksi - 2.0) / (r.X + 2.0) ** 2
        slope, co = self.osmc.slope(r.ca), self.co_ion
        by_J = dX * r.by_J + slope * sol.c[:, co] * sol.dkdJ[:, co]
        return by_J, dX[:, None] * r.by_c + slope[:, None] * sol.by_concentration(co)


register(Manning, "osm-coef-Manning")
