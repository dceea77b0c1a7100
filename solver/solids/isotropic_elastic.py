"""Linear law between second Piola-Kirchhoff stress and Green-Lagrange strain, for small strains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..jit import kernel
from ..kernels.tensors import add_circle, add_dyad, left_cauchy_green, square
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .lame import lame, shear_and_first
from .registry import register


@kernel
def _run(F, J, par, s, c):
    b, b2 = np.empty(6), np.empty(6)
    for i in range(len(J)):
        m = i if par.shape[0] > 1 else 0
        lam, mu = lame(par[m, 0], par[m, 1])
        left_cauchy_green(F, i, 1.0, b)
        square(b, b2)
        lam /= J[i]
        mu /= J[i]
        q = lam * 0.5 * (b[0] + b[1] + b[2] - 3.0) - mu
        for a in range(6):
            s[i, a] += q * b[a] + mu * b2[a]
        if c.shape[0] > 0:
            add_dyad(c, i, lam, b)
            add_circle(c, i, 2.0 * mu, b)


@dataclass(eq=False)
class IsotropicElastic(Solid):
    """S = lambda tr(E) I + 2 mu E, W = lambda (tr E)^2 / 2 + mu E : E."""

    E: Number = 0.0
    v: Number = 0.0
    parameters = ("E", "v")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        _run(pts.F, pts.J, self.par(pts), s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        lam, mu = shear_and_first(self.par(pts))
        strain = 0.5 * (np.swapaxes(pts.F, 1, 2) @ pts.F - np.eye(3))
        return 0.5 * lam * np.trace(strain, axis1=1, axis2=2) ** 2 + mu * (strain**2).sum((1, 2))


register(IsotropicElastic, "isotropic elastic")
