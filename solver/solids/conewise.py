"""Conewise linear elastic solids: other stiffness in tension than in compression."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .orthotropic import LocalStrain, linear, stiffness
from .registry import register


@dataclass(eq=False)
class OrthotropicConewise(LocalStrain):
    """S = sum mu_i sym(A_i E) + sum lambda_ij E_ii A_j, lambda_ii = lp where E_ii >= 0, else lm.

    Curnier, He & Zysset, J. Elasticity 37 (1995) 1, with FEBio's factor of the shear terms.
    """

    lp11: Number = 0.0
    lp22: Number = 0.0
    lp33: Number = 0.0
    lm11: Number = 0.0
    lm22: Number = 0.0
    lm33: Number = 0.0
    l12: Number = 0.0
    l23: Number = 0.0
    l31: Number = 0.0
    mu1: Number = 0.0
    mu2: Number = 0.0
    mu3: Number = 0.0
    parameters = (
        "lp11", "lp22", "lp33", "lm11", "lm22", "lm33", "l12", "l23", "l31", "mu1", "mu2", "mu3",
    )  # fmt: skip

    def twelve(self, pts: Points) -> Floats:
        """The parameters of the orthotropic law (1|n, 12)."""
        return self.par(pts)

    def law(self, pts: Points, E: Floats) -> tuple[Floats, Floats, Floats]:
        par = np.broadcast_to(self.twelve(pts), (pts.n, 12))
        l = np.empty((pts.n, 3, 3))
        l[:, [0, 1, 2], [0, 1, 2]] = np.where(E[:, :3] >= 0, par[:, :3], par[:, 3:6])
        for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 0))):
            l[:, i, j] = l[:, j, i] = par[:, 6 + k]
        D = stiffness(l, 0.5 * par[:, 9:])
        S, W = linear(E, D)
        return S, D, W


@dataclass(eq=False)
class CubicConewise(LocalStrain):
    """:class:`OrthotropicConewise` with one modulus of each kind."""

    lp1: Number = 0.0
    lm1: Number = 0.0
    l2: Number = 0.0
    mu: Number = 0.0
    parameters = ("lp1", "lm1", "l2", "mu")
    law = OrthotropicConewise.law

    def twelve(self, pts: Points) -> Floats:
        return self.par(pts)[:, [0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3]]


register(OrthotropicConewise, "orthotropic CLE")
register(CubicConewise, "cubic CLE")
