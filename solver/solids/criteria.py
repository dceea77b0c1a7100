"""Criteria of damage and yield: a scalar of the state of a solid, and its derivative by the stress."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ..kernels.return_map import mises, octahedral
from ..matrices import det, eigh, eigvalsh
from ..points import Points
from ..record import variable_record
from ..values import as_value
from .base import Floats, Number, Property, Solid
from .registry import register
from .voigt import deviator, matrix, spectral, strain

_EYE = np.eye(3)
_NO_GRADIENT = np.empty((0, 3, 3))


def _stress(base: Solid, pts: Points) -> Floats:
    s = np.zeros((pts.n, 6))
    base.stress(pts, s, None)
    return matrix(s)


def _trace(m: Floats) -> Floats:
    return np.trace(m, axis1=1, axis2=2)


def _mises(s: Floats) -> Floats:
    return np.sqrt(1.5 * (deviator(s) ** 2).sum((1, 2)))


def _dyad(v: Floats) -> Floats:
    return v[:, :, None] * v[:, None, :]


@variable_record
class Criterion:
    """``of(base, pts)`` (n,); ``gradient(base, pts)`` d/d sigma (n, 3, 3) where it is a yield criterion."""

    parameters: ClassVar[tuple[str, ...]] = ()
    options: ClassVar[tuple[str, ...]] = ()
    properties: ClassVar[dict[str, Property]] = {}

    def of(self, base: Solid, pts: Points) -> Floats:
        raise NotImplementedError

    def gradient(self, base: Solid, pts: Points) -> Floats:
        raise NotImplementedError(f"{type(self).__name__} is no yield criterion")

    def p(self, name: str, pts: Points) -> Floats:
        return as_value(getattr(self, name))(pts.t, pts.X, pts.e)


@variable_record
class SimoEnergy(Criterion):
    """(2 W)^1/2."""

    def of(self, base: Solid, pts: Points) -> Floats:
        return np.sqrt(2.0 * np.maximum(base.energy(pts), 0.0))


@variable_record
class StrainEnergy(Criterion):
    """W."""

    def of(self, base: Solid, pts: Points) -> Floats:
        return base.energy(pts)


@variable_record
class SpecificStrainEnergy(Criterion):
    """W / density."""

    def of(self, base: Solid, pts: Points) -> Floats:
        return base.energy(pts) / base.density(pts)


@variable_record
class VonMises(Criterion):
    """(3/2 dev sigma : dev sigma)^1/2."""

    def of(self, base: Solid, pts: Points) -> Floats:
        return self._both(base, pts, _NO_GRADIENT)

    def gradient(self, base: Solid, pts: Points) -> Floats:
        out = np.empty((pts.n, 3, 3))
        self._both(base, pts, out)
        return out

    @staticmethod
    def _both(base: Solid, pts: Points, gradient: Floats) -> Floats:
        s, measure = np.zeros((pts.n, 6)), np.empty(pts.n)
        base.stress(pts, s, None)
        mises(s, measure, gradient)
        return measure


@variable_record
class Drucker(Criterion):
    """(J2^3 - c J3^2)^1/6."""

    c: Number = 0.0
    parameters = ("c",)

    def of(self, base: Solid, pts: Points) -> Floats:
        d = deviator(_stress(base, pts))
        J2, J3 = 0.5 * (d**2).sum((1, 2)), det(d)
        return (J2**3 - self.p("c", pts) * J3**2) ** (1.0 / 6.0)

    def gradient(self, base: Solid, pts: Points) -> Floats:
        d = deviator(_stress(base, pts))
        J2, J3 = (0.5 * (d**2).sum((1, 2)))[:, None, None], det(d)[:, None, None]
        c = self.p("c", pts)[:, None, None]
        tau = (J2**3 - c * J3**2) ** (1.0 / 6.0)
        cofactor = deviator(d @ d - J2 * _EYE)  # J3 d^-1 where d is regular
        return (0.5 * J2**2 * d - c / 3.0 * J3 * cofactor) / tau**5


@variable_record
class MaxShear(Criterion):
    """(s3 - s1)/2."""

    def of(self, base: Solid, pts: Points) -> Floats:
        w = eigvalsh(_stress(base, pts))
        return 0.5 * (w[:, 2] - w[:, 0])

    def gradient(self, base: Solid, pts: Points) -> Floats:
        w, V = eigh(_stress(base, pts))
        N = [_dyad(V[:, :, k]) for k in range(3)]
        tie = 1e-6 * np.abs(w[:, 2])
        low, mid = w[:, 2] - w[:, 0] > tie, w[:, 2] - w[:, 1] > tie
        first = np.where(mid, w[:, 1] > w[:, 0], False)[:, None, None]
        top = np.where(first, 0.5 * (N[2] - N[0]), 0.5 * (N[2] - 0.5 * (N[1] + N[0])))
        flat = np.where(low[:, None, None], 0.5 * (0.5 * (N[2] + N[1]) - N[0]), 0.0)
        return np.where(mid[:, None, None], top, flat)


@variable_record
class MaxNormalStress(Criterion):
    """The largest principal stress."""

    def of(self, base: Solid, pts: Points) -> Floats:
        return np.asarray(eigvalsh(_stress(base, pts))[:, 2], dtype=float)

    def gradient(self, base: Solid, pts: Points) -> Floats:
        w, V = eigh(_stress(base, pts))
        tie = 1e-6 * np.abs(w[:, 2])
        low, mid = w[:, 2] - w[:, 0] > tie, w[:, 2] - w[:, 1] > tie
        N2, N1 = _dyad(V[:, :, 2]), _dyad(V[:, :, 1])
        pair = np.where(low[:, None, None], N2 + N1, _EYE)
        return np.where(mid[:, None, None], N2, pair)


@variable_record
class MaxNormalStrain(Criterion):
    """The largest principal Green-Lagrange strain."""

    def of(self, base: Solid, pts: Points) -> Floats:
        return np.asarray(eigvalsh(strain(pts.F))[:, 2], dtype=float)


@variable_record
class OctahedralShearStrain(Criterion):
    """(2/3 dev E : dev E)^1/2."""

    def of(self, base: Solid, pts: Points) -> Floats:
        out = np.empty(pts.n)
        octahedral(np.ascontiguousarray(pts.F), out)
        return out


@variable_record
class OctahedralNaturalStrain(Criterion):
    """(2/3 dev h : dev h)^1/2, h = ln V."""

    def of(self, base: Solid, pts: Points) -> Floats:
        h = 0.5 * spectral(pts.F @ np.swapaxes(pts.F, 1, 2), np.log)
        return np.sqrt(2.0 / 3.0 * (deviator(h) ** 2).sum((1, 2)))


@variable_record
class DruckerPrager(Criterion):
    """von Mises stress - b tr(sigma)/3."""

    b: Number = 0.0
    parameters = ("b",)

    def of(self, base: Solid, pts: Points) -> Floats:
        s = _stress(base, pts)
        return _mises(s) - self.p("b", pts) * _trace(s) / 3.0

    def gradient(self, base: Solid, pts: Points) -> Floats:
        s = _stress(base, pts)
        b = self.p("b", pts)[:, None, None]
        return 1.5 / _mises(s)[:, None, None] * deviator(s) - b / (3.0 * np.sqrt(3.0)) * _EYE


@variable_record
class DeshpandeFleck(Criterion):
    """((se^2 + 9 beta^2 sm^2)/(1 + beta^2))^1/2, se the von Mises stress and sm the mean stress."""

    beta: Number = 0.0
    parameters = ("beta",)

    def of(self, base: Solid, pts: Points) -> Floats:
        s, beta = _stress(base, pts), self.p("beta", pts)
        return np.sqrt((_mises(s) ** 2 + (beta * _trace(s)) ** 2) / (1.0 + beta**2))

    def gradient(self, base: Solid, pts: Points) -> Floats:
        s, beta = _stress(base, pts), self.p("beta", pts)
        root = np.sqrt(_mises(s) ** 2 + (beta * _trace(s)) ** 2) * np.sqrt(1.0 + beta**2)
        mean = (beta**2 * _trace(s) / 3.0)[:, None, None]
        return 3.0 / root[:, None, None] * (0.5 * deviator(s) + mean * _EYE)


register(SimoEnergy, "DC Simo", "criterion")
register(StrainEnergy, "DC strain energy density", "criterion")
register(SpecificStrainEnergy, "DC specific strain energy", "criterion")
register(VonMises, "DC von Mises stress", "criterion")
register(Drucker, "DC Drucker shear stress", "criterion")
register(MaxShear, "DC max shear stress", "criterion")
register(MaxNormalStress, "DC max normal stress", "criterion")
register(MaxNormalStrain, "DC max normal Lagrange strain", "criterion")
register(OctahedralShearStrain, "DC octahedral shear strain", "criterion")
register(OctahedralNaturalStrain, "DC octahedral natural strain", "criterion")
register(DruckerPrager, "DC Drucker-Prager", "criterion")
register(DeshpandeFleck, "DC Deshpande-Fleck", "criterion")
