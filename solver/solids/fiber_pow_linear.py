"""Fibers with a toe of power type, then linear."""

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
def _tension(In, par, tension_only, sn, cn):
    for i in range(In.shape[0]):
        m = i if par.shape[0] > 1 else 0
        E, lam0, beta = par[m, 0], par[m, 1], par[m, 2]
        I0 = lam0 * lam0
        ksi = 0.25 * E / (beta - 1.0) / (lam0 * I0) * (I0 - 1.0) ** (2.0 - beta)
        b = ksi * (I0 - 1.0) ** (beta - 1.0) + 0.5 * E / lam0
        for j in range(In.shape[1]):
            x = In[i, j]
            sn[i, j] = cn[i, j] = 0.0
            if x >= 1.0 or not tension_only:
                if x < I0:
                    sn[i, j] = 2.0 * x * ksi * (x - 1.0) ** (beta - 1.0)
                    cn[i, j] = 4.0 * x * x * ksi * (beta - 1.0) * (x - 1.0) ** (beta - 2.0)
                else:
                    sn[i, j] = 2.0 * b * x - E * math.sqrt(x)
                    cn[i, j] = E * math.sqrt(x)


@variable_record
class _PowLinear(FiberLaw):
    tension_only = 1

    def tension(self, pts: Points, In: Floats, sn: Floats, cn: Floats) -> Floats:
        _tension(In, self._three(pts), int(self.tension_only), sn, cn)
        return np.empty((0, 0))

    def _three(self, pts: Points) -> Floats:
        """E, lam0, beta in columns."""
        return self.par(pts)  # type: ignore[attr-defined, no-any-return]

    def fiber_energy(self, pts: Points, In: Floats) -> Floats:
        E, lam0, beta = self._three(pts).T[:, :, None]
        I0 = lam0**2
        ksi = 0.25 * E / (beta - 1) / lam0**3 * (I0 - 1) ** (2 - beta)
        b = ksi * (I0 - 1) ** (beta - 1) + 0.5 * E / lam0
        x = np.maximum(In, 1.0) if self.tension_only else In
        toe = ksi / beta * (np.minimum(x, I0) - 1) ** beta
        y = np.maximum(x, I0)
        return toe + b * (y - I0) - E * (np.sqrt(y) - lam0)


@variable_record
class FiberPowLinear(_PowLinear, Fiber):
    """W = ksi (In - 1)^beta / beta up to In = lam0^2, then b (In - I0) - E (sqrt In - lam0) + const.

    ksi = E (I0 - 1)^(2 - beta) / (4 (beta - 1) lam0^3) and b = ksi (I0 - 1)^(beta - 1) + E / (2 lam0) make
    stress and modulus continuous. FEBio Theory Manual, "Fiber with toe-linear response".
    """

    E: Number = 0.0
    lam0: Number = 1.0
    beta: Number = 2.0
    tension_only: int = 1
    parameters = ("E", "lam0", "beta")
    options = ("tension_only",)


@variable_record
class FiberPowLinearUncoupled(_PowLinear, UncoupledFiber):
    """The law of :class:`FiberPowLinear` in the distortional stretch."""

    E: Number = 0.0
    lam0: Number = 1.0
    beta: Number = 2.0
    parameters = ("E", "lam0", "beta")


for _table in ("solid", "fiber"):
    register(FiberPowLinear, "fiber-pow-linear", _table)
    register(FiberPowLinearUncoupled, "fiber-pow-linear-uncoupled", _table)
