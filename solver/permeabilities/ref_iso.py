"""Referentially isotropic permeability."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..points import Points
from . import register
from .base import Permeability
from .ref_ortho import add_referential


@dataclass(eq=False)
class RefIso(Permeability):
    """K = k0 I + k1 b + 2 k2 b^2: the orthotropic law with equal axes.

    Ateshian & Weiss, J. Biomech. Eng. 132 (2010) 111004.
    """

    perm0: Number = 1.0
    perm1: Number = 0.0
    perm2: Number = 0.0
    M: Number = 0.0
    alpha: Number = 0.0
    parameters = ("perm0", "perm1", "perm2", "M", "alpha")

    def permeability(self, pts: Points, phi_r: Floats, K: Floats, dK: Floats | None) -> None:
        columns = [0, 3, 4, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4]
        add_referential(self, self.par(pts)[:, columns], pts, phi_r, K, dK)


register(RefIso, "perm-ref-iso")
