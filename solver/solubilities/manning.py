"""Solubility by Manning's activity coefficient of mobile ions in a charged gel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats, Number
from ..multiphasic.manning import Function, ratio
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import Solubility


@dataclass(eq=False)
class Manning(Solubility):
    """kappa_hat = k(X) solub(ca), X = |cF| / ca of the co-ion (its index in the material), Y = X / ksi.

    k = exp(ksi X / (2 (X + 2))) where ksi <= 1, else exp(Y / (2 (Y + 2))), times (X + 1) / (Y + 1) for counterions.
    ``solub`` is Wells' correction as a function of the co-ion's concentration.
    Manning, J. Chem. Phys. 51 (1969) 924; FEBio User Manual, "Manning Solubility". FEBio 4.11 takes cF with its sign in
    the value and |cF| in the slopes; here both are of |cF|, as in the theory.
    """

    solub: Function
    co_ion: int = 0
    ksi: Number = 1.0
    parameters = ("ksi",)
    needed = ("solub", "co_ion")

    def _activity(self, X: Floats, ksi: Floats, own: bool) -> tuple[Floats, Floats]:
        """k (n,) and dk/dX."""
        low = np.exp(0.5 * ksi * X / (X + 2.0))
        Y = X / ksi
        high = np.exp(0.5 * Y / (Y + 2.0))
        slope_low = ksi * low / (X + 2.0) ** 2
        slope_high = high / ksi / (Y + 2.0) ** 2
        if not own:
            slope_high = slope_high * (X + 1.0) / (Y + 1.0) + high * (1.0 - 1.0 / ksi) / (Y + 1.0) ** 2
            high = high * (X + 1.0) / (Y + 1.0)
        return np.where(ksi <= 1.0, low, high), np.where(ksi <= 1.0, slope_low, slope_high)

    def solubility(self, pts: Points, sol: Solution, i: int) -> Floats:
        r = ratio(pts, sol, self.co_ion)
        return self._activity(r.X, self.par(pts)[:, 0], i == self.co_ion)[0] * self.solub.value(r.ca)

    def slopes(self, pts: Points, sol: Solution, i: int) -> tuple[Floats, Floats]:
        r = ratio(pts, sol, self.co_ion)
        k, dk = self._activity(r.X, self.par(pts)[:, 0], i == self.co_ion)
        wells, slope = self.solub.value(r.ca), self.solub.slope(r.ca)
        co = self.co_ion
        by_J = dk * r.by_J * wells + k * slope * sol.c[:, co] * sol.dkdJ[:, co]
        by_c = (dk * wells)[:, None] * r.by_c + (k * slope)[:, None] * sol.by_concentration(co)
        return by_J, by_c


register(Manning, "solub-Manning")
