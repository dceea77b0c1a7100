"""Newtonian viscous solids: stress proportional to the rate of deformation."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ..jit import kernel
from ..kernels.tensors import add_identity
from ..matrices import inv
from ..points import Points
from ..record import variable_record
from .base import Floats, Number, Solid, wanted
from .registry import register
from .uncoupled import Uncoupled
from .voigt import vector


@kernel
def _add_isotropic(k1, k4, c):
    for i in range(len(k1)):
        add_identity(c, i, k1[i], k4[i])


@variable_record
class _Viscous:
    """sigma = (kappa - 2 mu / 3) tr D I + 2 mu D, D = sym[(F - F_old) F^-1] / dt. History: F."""

    consistent = False
    kappa: Number = 0.0
    mu: Number = 0.0
    secant_tangent: int = 0
    parameters: ClassVar[tuple[str, ...]] = ("kappa", "mu")
    options: ClassVar[tuple[str, ...]] = ("secant_tangent",)
    history = 9

    def initial(self, n: int) -> Floats:
        return np.tile(np.eye(3).ravel(), (n, 1))

    def _rate(self, pts: Points) -> Floats:
        """D (n, 3, 3); zero outside a time step."""
        at = self.offset  # type: ignore[attr-defined]
        if pts.new is not None:
            pts.new[:, at : at + 9] = pts.F.reshape(pts.n, 9)
        if pts.dt == 0:
            return np.zeros_like(pts.F)
        old = np.eye(3) if pts.old is None else pts.old[:, at : at + 9].reshape(-1, 3, 3)
        L = (pts.F - old) @ inv(pts.F) / pts.dt
        return 0.5 * (L + np.swapaxes(L, 1, 2))

    def _stress(self, pts: Points) -> Floats:
        kappa, mu = self.par(pts).T[:, :, None, None]  # type: ignore[attr-defined]
        D = self._rate(pts)
        tr = np.trace(D, axis1=1, axis2=2)[:, None, None]
        return (kappa - 2.0 / 3.0 * mu) * tr * np.eye(3) + 2.0 * mu * D

    def _tangent(self, pts: Points, c: Floats, scale: Floats | float) -> None:
        """The part of the tangent that grows with 1/dt."""
        if pts.dt == 0:
            return
        kappa, mu = self.par(pts).T  # type: ignore[attr-defined]
        k = np.broadcast_to(scale, (pts.n,)) / pts.dt
        _add_isotropic((kappa - 2.0 / 3.0 * mu) * k, 2.0 * mu * k, c)

    def energy(self, pts: Points) -> Floats:
        return np.zeros(pts.n)


@variable_record
class NewtonianViscous(_Viscous, Solid):
    """sigma = (kappa - 2 mu / 3) tr D I + 2 mu D."""

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        s += vector(self._stress(pts))
        if c is not None:
            self._tangent(pts, wanted(c), 1.0)


@variable_record
class NewtonianViscousUncoupled(_Viscous, Uncoupled):
    """sigma = 2/J dev[(kappa - 2 mu / 3) tr D I + 2 mu D], with FEBio's factor 2/J."""

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        t = vector(self._stress(pts))
        t[:, :3] -= t[:, :3].mean(1, keepdims=True)
        s += 2.0 / pts.J[:, None] * t
        if c is not None and pts.dt > 0:
            k = 4.0 * self.par(pts)[:, 1] / (pts.J * pts.dt)
            _add_isotropic(-k / 3.0, k, c)

    def dev_energy(self, pts: Points) -> Floats:
        return np.zeros(pts.n)

    energy = Uncoupled.energy


@variable_record
class CarreauYasuda(_Viscous, Solid):
    """sigma = 2 mu D, mu = mui + (mu0 - mui) (1 + (lambda g)^a)^((n - 1)/a), g = (2 D : D)^1/2."""

    mu0: Number = 0.0
    mui: Number = 0.0
    lambda_: Number = 0.0
    n: Number = 1.0
    a: Number = 2.0
    parameters = ("mu0", "mui", "lambda_", "n", "a")
    options = ()

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        mu0, mui, lam, n, a = self.par(pts).T
        D = self._rate(pts)
        g = np.sqrt(2.0 * (D**2).sum((1, 2)))
        x = 1.0 + (lam * g) ** a
        mu = mui + (mu0 - mui) * x ** ((n - 1.0) / a)
        s += vector(2.0 * mu[:, None, None] * D)
        if c is None or pts.dt == 0:
            return
        slope = 2.0 * (mu0 - mui) * (n - 1.0) * lam**a * g ** (a - 2.0) * x ** ((n - a - 1.0) / a)
        _add_isotropic(np.zeros(pts.n), 2.0 * mu / pts.dt, c)
        d = vector(D)
        c += (2.0 * slope / pts.dt)[:, None, None] * d[:, :, None] * d[:, None, :]


register(CarreauYasuda, "Carreau-Yasuda viscous solid")
register(NewtonianViscous, "Newtonian viscous solid")
register(NewtonianViscousUncoupled, "Newtonian viscous solid uncoupled")
