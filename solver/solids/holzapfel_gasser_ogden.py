"""Holzapfel-Gasser-Ogden arterial walls: two families of dispersed fibers."""

from __future__ import annotations

from dataclasses import field
from typing import ClassVar

import numpy as np

from ..kernels.wall import wall
from ..points import Points
from ..record import variable_record
from ..values import as_value
from .base import Floats, Number, Solid, wanted
from .registry import register
from .uncoupled import Uncoupled, add_volumetric


@variable_record
class _Wall(Solid):
    c: Number = 0.0
    k1: Number = 0.0
    k2: Number = 0.0
    kappa: Number = 0.0
    gamma: Number = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("c", "k1", "k2", "kappa", "gamma")
    iso = False

    def _families(self, pts: Points) -> tuple[Floats, list[Floats], Floats]:
        """F (or F~), the two reference directions (1|n, 3) and tr C."""
        F = pts.F * pts.J[:, None, None] ** (-1.0 / 3.0) if self.iso else pts.F
        g = np.radians(self.par(pts)[:, 4])[:, None]
        Q = self.inner(pts).Q
        Q = np.eye(3)[None] if Q is None else Q
        a = [Q[:, :, 0] * np.cos(g) + sign * Q[:, :, 1] * np.sin(g) for sign in (1.0, -1.0)]
        return F, a, (F**2).sum((1, 2))

    def _wall(self, pts: Points, s: Floats, c: Floats | None) -> None:
        """Add the stress of matrix and fibers, and its tangent."""
        Q = self.inner(pts).Q
        wall(pts.F, pts.J, self.par(pts), np.eye(3)[None] if Q is None else Q, self.iso, s, wanted(c))

    def _wall_energy(self, pts: Points) -> Floats:
        c, k1, k2, kappa = self.par(pts).T[:4]
        F, directions, I1 = self._families(pts)
        W = 0.5 * c * (I1 - 3)
        for a0 in directions:
            I4 = (np.einsum("nij,nj->ni", F, np.broadcast_to(a0, (pts.n, 3))) ** 2).sum(1)
            E = np.maximum(kappa * (I1 - 3) + (1 - 3 * kappa) * (I4 - 1), 0.0)
            W = W + 0.5 * k1 / k2 * np.expm1(k2 * E * E)
        return W


@variable_record
class HolzapfelGasserOgden(_Wall, Uncoupled):
    """W~ = c (I1~ - 3)/2 + k1/(2 k2) sum_a (exp[k2 E_a^2] - 1), E_a = kappa (I1~ - 3) + (1 - 3 kappa)(I4a~ - 1).

    Gasser, Ogden & Holzapfel, J. R. Soc. Interface 3 (2006) 15.
    """

    pressure_model: int = field(default=3, kw_only=True)
    iso = True

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._wall(pts, s, c)

    def dev_energy(self, pts: Points) -> Floats:
        return self._wall_energy(pts)

    stress = Uncoupled.stress
    energy = Uncoupled.energy


@variable_record
class HolzapfelUnconstrained(_Wall):
    """W = c (I1 - 3 - 2 ln J)/2 + k (J^2 - 1 - 2 ln J)/4 and the fibers of the wall in the whole stretch."""

    k: Number = field(default=0.0, kw_only=True)
    parameters = (*_Wall.parameters, "k")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._wall(pts, s, c)
        k, c0, J = as_value(self.k)(pts.t, pts.X, pts.e), self.par(pts)[:, 0], pts.J
        p = 0.5 * k * (J - 1.0 / J) - c0 / J
        add_volumetric(J, p, 0.5 * k * (1.0 + 1.0 / J**2) + c0 / J**2, s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        k, J = as_value(self.k)(pts.t, pts.X, pts.e), pts.J
        lnJ = np.log(J)
        return self._wall_energy(pts) - self.par(pts)[:, 0] * lnJ + 0.25 * k * (J**2 - 1.0 - 2.0 * lnJ)


register(HolzapfelGasserOgden, "Holzapfel-Gasser-Ogden")
register(HolzapfelUnconstrained, "HGO unconstrained")
