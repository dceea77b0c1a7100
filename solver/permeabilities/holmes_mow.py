"""Strain-dependent isotropic permeability of Holmes and Mow."""

from __future__ import annotations

import numpy as np

from ..kernels.permeability import isotropic
from ..law import Floats, Number
from ..points import Points
from ..record import variable_record
from . import register
from .base import Permeability, open_pores, wanted


@variable_record
class HolmesMow(Permeability):
    """K = perm ((J - phi_r) / (1 - phi_r))^alpha exp(M (J^2 - 1) / 2) I.

    Holmes & Mow, J. Biomech. 23 (1990) 1145, eq. 24.
    """

    perm: Number = 1.0
    M: Number = 0.0
    alpha: Number = 0.0
    parameters = ("perm", "M", "alpha")

    def permeability(self, pts: Points, phi_r: Floats, K: Floats, dK: Floats | None) -> None:
        perm, M, alpha = self.par(pts).T
        J = pts.J
        if alpha.any():
            open_pores(pts, phi_r)
        k = perm * ((J - phi_r) / (1.0 - phi_r)) ** alpha * np.exp(0.5 * M * (J * J - 1.0))
        isotropic(k, k * J * (alpha / (J - phi_r) + M * J), K, wanted(dK))


register(HolmesMow, "perm-Holmes-Mow")
