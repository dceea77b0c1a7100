"""Fibers whose energy is the exponential of a power of the squared stretch."""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from ..points import Points
from ..record import variable_record
from .base import Floats, Number
from .fiber import Fiber, FiberLaw, UncoupledFiber
from .registry import register


@kernel
def _tension(In, par, eps, sn, cn, g):
    for i in range(In.shape[0]):
        m = i if par.shape[0] > 1 else 0
        alpha, beta, ksi, I0 = par[m, 0], par[m, 1], par[m, 2], par[m, 4] ** 2
        for j in range(In.shape[1]):
            x = In[i, j] - I0
            sn[i, j] = cn[i, j] = 0.0
            if g.shape[0] > 0:
                g[i, j] = 0.0
            if x >= eps:
                x = max(x, 0.0)
                p = 1.0 if beta == 2.0 else x ** (beta - 2.0)
                q = alpha * p * x * x
                e = ksi * p * math.exp(q)
                sn[i, j] = 2.0 * In[i, j] * e * x
                cn[i, j] = 4.0 * In[i, j] * In[i, j] * e * ((q + 1.0) * beta - 1.0)
                if g.shape[0] > 0:
                    g[i, j] = par[m, 3]


@variable_record
class _ExpPow(FiberLaw):
    _eps = -1e-15

    def tension(self, pts: Points, In: Floats, sn: Floats, cn: Floats) -> Floats:
        par = self._five(pts)
        g = np.empty(In.shape if par[:, 3].any() else (0, 0))
        _tension(In, par, self._eps, sn, cn, g)
        return g

    def shears(self, pts: Points) -> bool:
        return bool(self._five(pts)[:, 3].any())

    def fiber_energy(self, pts: Points, In: Floats) -> Floats:
        alpha, beta, ksi, _, lam0 = self._five(pts).T[:, :, None]
        x = np.maximum(In - lam0**2, 0.0)
        some = np.where(alpha > 0, alpha, 1.0)
        return np.where(alpha > 0, ksi / (some * beta) * np.expm1(alpha * x**beta), ksi / beta * x**beta)

    def shear_energy(self, pts: Points, A: Floats, In: Floats) -> Floats | float:
        _, _, _, mu, lam0 = self._five(pts).T[:, :, None]
        if not mu.any():
            return 0.0
        C = np.swapaxes(pts.F, 1, 2) @ pts.F
        if self.iso:
            C = C * pts.J[:, None, None] ** (-2.0 / 3.0)
        Ca = np.einsum("nij,nmj->nmi", C, np.broadcast_to(A, (pts.n, *A.shape[1:])))
        return np.where(In >= lam0**2, 0.25 * mu * ((Ca**2).sum(2) - 2.0 * (In - 1.0) - 1.0), 0.0)

    def _five(self, pts: Points) -> Floats:
        """alpha, beta, ksi, mu, lam0 in columns."""
        return self.par(pts)  # type: ignore[attr-defined, no-any-return]


@variable_record
class FiberExpPow(_ExpPow, Fiber):
    """W = ksi (exp[alpha (In - lam0^2)^beta] - 1) / (alpha beta) in tension, In = a0 . C a0.

    The shear term mu (a0 . C^2 a0 - 2 (In - 1) - 1) / 4 acts where the fiber is in tension.
    """

    alpha: Number = 0.0
    beta: Number = 2.0
    ksi: Number = 0.0
    mu: Number = 0.0
    lam0: Number = 1.0
    parameters = ("alpha", "beta", "ksi", "mu", "lam0")


@variable_record
class FiberExponentialPower(FiberExpPow):
    """The same law under its older name."""


@variable_record
class FiberExpPowUncoupled(_ExpPow, UncoupledFiber):
    """The law of :class:`FiberExpPow` in the distortional stretch, lam0 = 1."""

    alpha: Number = 0.0
    beta: Number = 2.0
    ksi: Number = 0.0
    mu: Number = 0.0
    parameters = ("alpha", "beta", "ksi", "mu")
    _eps = 0.0

    def _five(self, pts: Points) -> Floats:
        par = self.par(pts)
        return np.column_stack((par, np.ones(len(par))))


@variable_record
class FiberExponentialPowerUncoupled(FiberExpPowUncoupled):
    """The same law under its older name."""


for _table in ("solid", "fiber"):
    register(FiberExpPow, "fiber-exp-pow", _table)
    register(FiberExpPowUncoupled, "fiber-exp-pow-uncoupled", _table)
register(FiberExponentialPower, "fiber-exponential-power-law")
register(FiberExponentialPowerUncoupled, "fiber-exponential-power-law-uncoupled")
