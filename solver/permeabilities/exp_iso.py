"""Isotropic permeability that vanishes exponentially as the pores close."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.permeability import isotropic
from ..law import Floats, Number
from ..points import Points
from . import register
from .base import Permeability, open_pores, wanted


@dataclass(eq=False)
class ExpIso(Permeability):
    """K = perm exp(M (J - 1) / (J - phi_r)) I. FEBio User Manual, "Exponential Isotropic Permeability"."""

    perm: Number = 1.0
    M: Number = 0.0
    parameters = ("perm", "M")

    def permeability(self, pts: Points, phi_r: Floats, K: Floats, dK: Floats | None) -> None:
        perm, M = self.par(pts).T
        J = pts.J
        open_pores(pts, phi_r)
        k = perm * np.exp(M * (J - 1.0) / (J - phi_r))
        isotropic(k, k * J * M * (1.0 - phi_r) / (J - phi_r) ** 2, K, wanted(dK))


register(ExpIso, "perm-exp-iso")
