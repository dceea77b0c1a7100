"""Fibers whose stiffness grows with a power of what is bound to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .bound import Bound
from .fiber import Fiber
from .fiber_exp_pow import _ExpPow
from .fiber_pow_linear import _PowLinear
from .registry import register


@dataclass(eq=False)
class FiberExpPowBound(Bound, _ExpPow, Fiber):
    """As :class:`.fiber_exp_pow.FiberExpPow`, ksi = ksi0 (rho / rho0)^gamma. FEBio User Manual, "fiber-exp-pow sbm"."""

    alpha: Number = 0.0
    beta: Number = 2.0
    ksi0: Number = 0.0
    rho0: Number = 1.0
    gamma: Number = 0.0
    sbm: int | str = 0
    parameters = ("alpha", "beta", "ksi0", "rho0", "gamma")

    def _five(self, pts: Points) -> Floats:
        alpha, beta, ksi0 = self.par(pts)[:, :3].T
        return np.stack(np.broadcast_arrays(alpha, beta, ksi0 * self.factor(pts), 0.0, 1.0), axis=1)


@dataclass(eq=False)
class FiberPowLinearBound(Bound, _PowLinear, Fiber):
    """As :class:`.fiber_pow_linear.FiberPowLinear`, E = E0 (rho / rho0)^gamma. FEBio User Manual, "fiber-pow-linear
    sbm"."""

    E0: Number = 0.0
    lam0: Number = 1.0
    beta: Number = 2.0
    rho0: Number = 1.0
    gamma: Number = 0.0
    sbm: int | str = 0
    parameters = ("E0", "lam0", "beta", "rho0", "gamma")

    def _three(self, pts: Points) -> Floats:
        E0, lam0, beta = self.par(pts)[:, :3].T
        return np.stack(np.broadcast_arrays(E0 * self.factor(pts), lam0, beta), axis=1)


register(FiberExpPowBound, "fiber-exp-pow sbm")
register(FiberPowLinearBound, "fiber-pow-linear sbm")
