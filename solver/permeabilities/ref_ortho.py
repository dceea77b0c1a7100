"""Referentially orthotropic permeability, and what the isotropic and transversely isotropic ones share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.permeability import referential
from ..law import Floats, Number
from ..points import Points
from . import register
from .base import Permeability, open_pores, wanted

#: columns of a referential law: perm0, M0, alpha0, then perm1, perm2, M, alpha for three axes
FIRST_EXPONENT, EXPONENTS = 2, slice(12, 15)


def add_referential(
    law: Permeability, par: Floats, pts: Points, phi_r: Floats, K: Floats, dK: Floats | None
) -> None:
    """Add a permeability of the referential family with columns ``par`` (1|n, 15)."""
    if par[:, FIRST_EXPONENT].any() or par[:, EXPONENTS].any():
        open_pores(pts, phi_r)
    referential(pts.F, pts.J, np.atleast_1d(phi_r), law.axes(pts), np.ascontiguousarray(par), K, wanted(dK))


@dataclass(eq=False)
class RefOrtho(Permeability):
    """K = k0 I + sum_a [k1_a m_a + k2_a (m_a b + b m_a)] over three material axes.

    k0 = perm0 s(M0, alpha0), k1_a = perm1_a s(M_a, alpha_a) / J^2, k2_a = perm2_a s(M_a, alpha_a) / (2 J^4),
    s(M, alpha) = ((J - phi_r) / (1 - phi_r))^alpha exp(M (J^2 - 1) / 2).
    Ateshian & Weiss, J. Biomech. Eng. 132 (2010) 111004.
    """

    perm0: Number = 1.0
    M0: Number = 0.0
    alpha0: Number = 0.0
    perm1: tuple[Number, ...] = (0.0, 0.0, 0.0)
    perm2: tuple[Number, ...] = (0.0, 0.0, 0.0)
    M: tuple[Number, ...] = (0.0, 0.0, 0.0)
    alpha: tuple[Number, ...] = (0.0, 0.0, 0.0)
    parameters = ("perm0", "M0", "alpha0", "perm1", "perm2", "M", "alpha")
    vectors = {"perm1": 3, "perm2": 3, "M": 3, "alpha": 3}

    def permeability(self, pts: Points, phi_r: Floats, K: Floats, dK: Floats | None) -> None:
        add_referential(self, self.par(pts), pts, phi_r, K, dK)


register(RefOrtho, "perm-ref-ortho")
