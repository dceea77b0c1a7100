"""Referentially transversely isotropic permeability; the axis is the first material axis."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..points import Points
from . import register
from .base import Permeability
from .ref_ortho import add_referential


@dataclass(eq=False)
class RefTransIso(Permeability):
    """The orthotropic law with equal second and third axes (T), the first being the axis of symmetry (A).

    Ateshian & Weiss, J. Biomech. Eng. 132 (2010) 111004.
    """

    perm0: Number = 1.0
    perm1T: Number = 0.0
    perm1A: Number = 0.0
    perm2T: Number = 0.0
    perm2A: Number = 0.0
    M0: Number = 0.0
    MT: Number = 0.0
    MA: Number = 0.0
    alpha0: Number = 0.0
    alphaT: Number = 0.0
    alphaA: Number = 0.0
    parameters = (
        "perm0", "M0", "alpha0", "perm1A", "perm1T", "perm2A", "perm2T", "MA", "MT", "alphaA", "alphaT",
    )

    def permeability(self, pts: Points, phi_r: Floats, K: Floats, dK: Floats | None) -> None:
        columns = [0, 1, 2, 3, 4, 4, 5, 6, 6, 7, 8, 8, 9, 10, 10]
        add_referential(self, self.par(pts)[:, columns], pts, phi_r, K, dK)


register(RefTransIso, "perm-ref-trans-iso")
