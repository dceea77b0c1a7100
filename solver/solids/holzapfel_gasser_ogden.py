"""Holzapfel-Gasser-Ogden arterial walls: two families of dispersed fibers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from ..points import Points
from ..values import as_value
from .base import Floats, Number, Solid, wanted
from .registry import register
from .uncoupled import Uncoupled, add_volumetric
from .voigt import deviator, vector

_ONE = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
_DEVIATORIC = np.diag([1.0, 1.0, 1.0, 0.5, 0.5, 0.5]) - np.outer(_ONE, _ONE) / 3.0


def _products(parts: list[tuple[Floats, Floats]], J: Floats) -> Floats:
    """sum w h x h / J (n, 6, 6)."""
    v = [(w / J, vector(h)) for w, h in parts]
    return np.asarray(sum(w[:, None, None] * h[:, :, None] * h[:, None, :] for w, h in v))


@dataclass(eq=False)
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

    def _wall(self, pts: Points) -> tuple[Floats, list[tuple[Floats, Floats]]]:
        """Kirchhoff stress of matrix and fibers (n, 3, 3); of each family 4 W'' (n,) and h = dE/dC pushed forward.

        Fibers at rest count as tense, so that the tangent is that of the loading to come.
        """
        c, k1, k2, kappa = self.par(pts).T[:4, :, None, None]
        F, directions, I1 = self._families(pts)
        b = F @ np.swapaxes(F, 1, 2)
        s, families = c * b, []
        for a0 in directions:
            a = np.einsum("nij,nj->ni", F, np.broadcast_to(a0, (pts.n, 3)))
            E = kappa * (I1[:, None, None] - 3) + (1 - 3 * kappa) * ((a**2).sum(1)[:, None, None] - 1)
            h = kappa * b + (1 - 3 * kappa) * a[:, :, None] * a[:, None, :]
            grown = np.exp(k2 * np.where(E >= 0, E, 0.0) ** 2)
            s = s + np.where(E >= 0, 2.0 * k1 * E * grown, 0.0) * h
            stiff = np.where(E >= 0, 4.0 * k1 * (1.0 + 2.0 * k2 * E * E) * grown, 0.0)
            families.append((stiff[:, 0, 0], h))
        return s, families

    def _wall_energy(self, pts: Points) -> Floats:
        c, k1, k2, kappa = self.par(pts).T[:4]
        F, directions, I1 = self._families(pts)
        W = 0.5 * c * (I1 - 3)
        for a0 in directions:
            I4 = (np.einsum("nij,nj->ni", F, np.broadcast_to(a0, (pts.n, 3))) ** 2).sum(1)
            E = np.maximum(kappa * (I1 - 3) + (1 - 3 * kappa) * (I4 - 1), 0.0)
            W = W + 0.5 * k1 / k2 * np.expm1(k2 * E * E)
        return W


@dataclass(eq=False)
class HolzapfelGasserOgden(_Wall, Uncoupled):
    """W~ = c (I1~ - 3)/2 + k1/(2 k2) sum_a (exp[k2 E_a^2] - 1), E_a = kappa (I1~ - 3) + (1 - 3 kappa)(I4a~ - 1).

    Gasser, Ogden & Holzapfel, J. R. Soc. Interface 3 (2006) 15.
    """

    pressure_model: int = field(default=3, kw_only=True)
    iso = True

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        tau, families = self._wall(pts)
        J = pts.J[:, None]
        own = vector(deviator(tau)) / J
        s += own
        if c is not None:
            c += _products([(w, deviator(h)) for w, h in families], pts.J)
            pair = own[:, :, None] * _ONE
            trace = np.trace(tau, axis1=1, axis2=2)[:, None, None] / J[:, :, None]
            c += 2.0 / 3.0 * (trace * _DEVIATORIC - pair - pair.transpose(0, 2, 1))

    def dev_energy(self, pts: Points) -> Floats:
        return self._wall_energy(pts)

    stress = Uncoupled.stress
    energy = Uncoupled.energy


@dataclass(eq=False)
class HolzapfelUnconstrained(_Wall):
    """W = c (I1 - 3 - 2 ln J)/2 + k (J^2 - 1 - 2 ln J)/4 and the fibers of the wall in the whole stretch."""

    k: Number = field(default=0.0, kw_only=True)
    parameters = (*_Wall.parameters, "k")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        tau, families = self._wall(pts)
        s += vector(tau) / pts.J[:, None]
        if c is not None:
            c += _products(families, pts.J)
        k, c0, J = as_value(self.k)(pts.t, pts.X, pts.e), self.par(pts)[:, 0], pts.J
        p = 0.5 * k * (J - 1.0 / J) - c0 / J
        add_volumetric(J, p, 0.5 * k * (1.0 + 1.0 / J**2) + c0 / J**2, s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        k, J = as_value(self.k)(pts.t, pts.X, pts.e), pts.J
        lnJ = np.log(J)
        return self._wall_energy(pts) - self.par(pts)[:, 0] * lnJ + 0.25 * k * (J**2 - 1.0 - 2.0 * lnJ)


register(HolzapfelGasserOgden, "Holzapfel-Gasser-Ogden")
register(HolzapfelUnconstrained, "HGO unconstrained")
