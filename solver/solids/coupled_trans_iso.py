"""Compressible Mooney-Rivlin and Veronda-Westmann solids with one family of fibers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..kernels.fibers import add_fibers, squared_stretch
from ..kernels.invariants import add_invariant
from ..points import Points
from .base import Floats, Number, Property, Solid, wanted
from .fiber import directions
from .fiber_exp_linear import fiber_energy, tension
from .hyperelastic import columns
from .invariants import invariants
from .registry import register


@dataclass(eq=False)
class _CoupledTransIso(Solid):
    """Fibers l dW/dl = c3 (exp[c4 (l - 1)] - 1) up to lam_max, then linear with c5; volumetric k (ln J)^2 / 2.

    The direction is taken in global axes, as in FEBio.
    """

    c1: Number = 0.0
    c2: Number = 0.0
    c3: Number = 0.0
    c4: Number = 0.0
    c5: Number = 0.0
    k: Number = 0.0
    fiber: Any = field(default=None, kw_only=True)
    properties = {"fiber": Property("direction", default="vector")}

    def matrix(self, par: Floats, I1: Floats, I2: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """W, W1, W2, W11 and J WJ, the part of WJ that makes the rest free of stress, each (1|n,)."""
        raise NotImplementedError

    def _directions(self, pts: Points) -> Floats:
        return directions(self.fiber, pts.but(Q=None))[:, None]

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        par, lnJ, J = self.par(pts), np.log(pts.J), pts.J
        k = par[:, 6]
        _, W1, W2, W11, r = self.matrix(par, *invariants(pts))
        WJ, WJJ = (r + k * lnJ) / J, (k - r - k * lnJ) / J**2
        add_invariant(pts.F, J, columns(pts, W1, W2, W11, 0.0, 0.0, WJ, WJJ), False, s, wanted(c))
        A = self._directions(pts)
        In = np.empty((pts.n, 1))
        squared_stretch(pts.F, J, A, False, In)
        sn, cn = np.empty_like(In), np.empty_like(In)
        tension(In, np.ascontiguousarray(par[:, 2:6]), sn, cn)
        add_fibers(pts.F, J, A, np.ones((1, 1)), In, sn, cn, np.empty((0, 0)), False, s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        par, lnJ = self.par(pts), np.log(pts.J)
        W, _, _, _, r = self.matrix(par, *invariants(pts))
        In = np.empty((pts.n, 1))
        squared_stretch(pts.F, pts.J, self._directions(pts), False, In)
        return W + r * lnJ + 0.5 * par[:, 6] * lnJ**2 + fiber_energy(In, par[:, 2:6])[:, 0]


@dataclass(eq=False)
class CoupledTransIsoMooneyRivlin(_CoupledTransIso):
    """W = c1 (I1 - 3) + c2 (I2 - 3) - 2 (c1 + 2 c2) ln J + fibers + k (ln J)^2 / 2."""

    lam_max: Number = 1.0
    parameters = ("c1", "c2", "c3", "c4", "c5", "lam_max", "k")

    def matrix(self, par: Floats, I1: Floats, I2: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        c1, c2 = par[:, 0], par[:, 1]
        return c1 * (I1 - 3) + c2 * (I2 - 3), c1, c2, 0.0 * c1, -2.0 * (c1 + 2.0 * c2)


@dataclass(eq=False)
class CoupledTransIsoVerondaWestmann(_CoupledTransIso):
    """W = c1 (exp[c2 (I1 - 3)] - 1) - c1 c2 (I2 - 3) / 2 + fibers + k (ln J)^2 / 2."""

    lambda_: Number = 1.0
    parameters = ("c1", "c2", "c3", "c4", "c5", "lambda_", "k")

    def matrix(self, par: Floats, I1: Floats, I2: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        c1, c2 = par[:, 0], par[:, 1]
        W1 = c1 * c2 * np.exp(c2 * (I1 - 3))
        W = c1 * np.expm1(c2 * (I1 - 3)) - 0.5 * c1 * c2 * (I2 - 3)
        return W, W1, -0.5 * c1 * c2, c2 * W1, 0.0 * c1


register(CoupledTransIsoMooneyRivlin, "coupled trans-iso Mooney-Rivlin")
register(CoupledTransIsoVerondaWestmann, "coupled trans-iso Veronda-Westmann")
