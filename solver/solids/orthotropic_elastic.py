"""Orthotropic linear law between second Piola-Kirchhoff stress and Green-Lagrange strain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats
from .orthotropic import Engineering, LocalStrain, linear
from .registry import register


@dataclass(eq=False)
class OrthotropicElastic(Engineering, LocalStrain):
    """S = D : E in the local axes, D from moduli and Poisson's ratios."""

    def law(self, pts: Points, E: Floats) -> tuple[Floats, Floats, Floats]:
        D = self.stiffness(self.par(pts))
        S, W = linear(E, D)
        return S, np.broadcast_to(D, (pts.n, 6, 6)), W


register(OrthotropicElastic, "orthotropic elastic")
