"""Compressible Arruda-Boyce solid with the inverse Langevin function as a long series."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .hyperelastic import Hyperelastic, columns
from .inverse_langevin import COEFFICIENTS, even_series
from .registry import register


@dataclass(eq=False)
class ArrudaBoyceUnconstrained(Hyperelastic):
    """W = ksi N int beta d(alpha) - W0 ln J + kappa ((J^2 - 1)/2 - ln J), alpha^2 = I1/(3N), beta the inverse
    Langevin function of alpha, W0 such that the rest is free of stress."""

    ksi: Number = 1e-5
    N: Number = 100.0
    kappa: Number = 0.0
    n_term: int = 30
    parameters = ("ksi", "N", "kappa")
    options = ("n_term",)

    def derivatives(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        ksi, N, kappa = self.par(pts).T
        beta, slope = even_series(I1 / (3.0 * N), self.n_term)
        W0 = ksi / 3.0 * even_series(1.0 / N, self.n_term)[0]
        WJ = -W0 / J + kappa * (J - 1.0 / J)
        WJJ = W0 / J**2 + kappa * (1.0 + 1.0 / J**2)
        return columns(pts, ksi / 6.0 * beta, 0.0, ksi / (18.0 * N) * slope, 0.0, 0.0, WJ, WJJ)

    def potential(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        ksi, N, kappa = self.par(pts).T
        W0 = ksi / 3.0 * even_series(1.0 / N, self.n_term)[0]
        c = np.array(COEFFICIENTS[: int(self.n_term)])
        x = np.append(0.0, c / np.arange(1, len(c) + 1))
        chain = 0.5 * ksi * N * (
            np.polynomial.polynomial.polyval(I1 / (3 * N), x) - np.polynomial.polynomial.polyval(1 / N, x)
        )
        return chain - W0 * np.log(J) + kappa * (0.5 * (J**2 - 1.0) - np.log(J))


register(ArrudaBoyceUnconstrained, "Arruda-Boyce unconstrained")
