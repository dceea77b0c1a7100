"""Constant isotropic permeability."""

from __future__ import annotations

from ..kernels.permeability import isotropic
from ..law import Floats, Number
from ..points import Points
from ..record import variable_record
from . import register
from .base import Permeability, wanted


@variable_record
class ConstIso(Permeability):
    """K = perm I in space, whatever the strain. FEBio User Manual, "Constant Isotropic Permeability"."""

    perm: Number = 1.0
    parameters = ("perm",)
    strain_dependent = False

    def permeability(self, pts: Points, phi_r: Floats, K: Floats, dK: Floats | None) -> None:
        k = self.par(pts)[:, 0].copy()
        isotropic(k, 0.0 * k, K, wanted(dK))


register(ConstIso, "perm-const-iso")
