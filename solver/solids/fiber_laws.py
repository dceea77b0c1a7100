"""Fibers with simple laws of the squared stretch: neo-Hookean, power, logarithmic, and their mixtures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..points import Points
from ..record import variable_record
from .base import Floats, Number
from .fiber import Fiber, FiberLaw, UncoupledFiber
from .registry import register

_NONE = np.empty((0, 0))


@variable_record
class _Law(FiberLaw):
    """Subclasses give W(In), dW/dIn and d2W/dIn2, arrays (n, m), and where the fiber bears load."""

    def law(self, pts: Points, In: Floats) -> tuple[NDArray[np.bool_], Floats, Floats, Floats]:
        """(bears load, W, W', W'')."""
        raise NotImplementedError

    def tension(self, pts: Points, In: Floats, sn: Floats, cn: Floats) -> Floats:
        on, _, W1, W2 = self.law(pts, In)
        sn[:] = np.where(on, 2.0 * In * W1, 0.0)
        cn[:] = np.where(on, 4.0 * In * In * W2, 0.0)
        return _NONE

    def fiber_energy(self, pts: Points, In: Floats) -> Floats:
        on, W, _, _ = self.law(pts, In)
        return np.where(on, W, 0.0)

    def columns(self, pts: Points) -> Floats:
        """Parameters (k, 1|n, 1)."""
        return self.par(pts).T[:, :, None]  # type: ignore[attr-defined, no-any-return]


@variable_record
class _NeoHookean(_Law):
    def law(self, pts: Points, In: Floats) -> tuple[NDArray[np.bool_], Floats, Floats, Floats]:
        (mu,) = self.columns(pts)
        x = In - 1.0
        return x > 0, 0.25 * mu * x * x, 0.5 * mu * x, 0.5 * mu + 0.0 * x


@variable_record
class FiberNeoHookean(_NeoHookean, Fiber):
    """W = mu (In - 1)^2 / 4."""

    mu: Number = 0.0
    parameters = ("mu",)


@variable_record
class FiberNeoHookeanUncoupled(_NeoHookean, UncoupledFiber):
    """W~ = mu (In~ - 1)^2 / 4."""

    mu: Number = 0.0
    parameters = ("mu",)


@variable_record
class FiberPower(_Law, Fiber):
    """W = ksi (In - 1)^beta."""

    ksi: Number = 0.0
    beta: Number = 2.0
    tension_only: int = 1
    parameters = ("ksi", "beta")
    options = ("tension_only",)

    def law(self, pts: Points, In: Floats) -> tuple[NDArray[np.bool_], Floats, Floats, Floats]:
        ksi, beta = self.columns(pts)
        on = (In >= 1.0) | (not self.tension_only)
        x = np.where(on, In - 1.0, 0.0)
        return on, ksi * x**beta, ksi * beta * x ** (beta - 1), ksi * beta * (beta - 1) * x ** (beta - 2)


@variable_record
class FiberExpPowLinear(_Law, Fiber):
    """W = ksi (exp[alpha (In - 1)^beta] - 1) / (alpha beta) up to In = lam0^2, then linear with modulus E.

    ksi and b such that stress and modulus are continuous. FEBio Theory Manual, "Fiber with exp-pow-linear".
    """

    E: Number = 0.0
    alpha: Number = 0.0
    beta: Number = 3.0
    lam0: Number = 1.0
    parameters = ("E", "alpha", "beta", "lam0")

    def law(self, pts: Points, In: Floats) -> tuple[NDArray[np.bool_], Floats, Floats, Floats]:
        E, alpha, beta, lam0 = self.columns(pts)
        I0 = lam0**2
        y = I0 - 1.0
        g = 4.0 * lam0**3 * (beta - 1 + alpha * beta * y**beta)
        ksi = E * y ** (2 - beta) * np.exp(-alpha * y**beta) / g
        b = E * (2 * I0 * (beta - 0.5 + alpha * beta * y**beta) - 1) / g
        x = np.clip(In - 1.0, 0.0, y)
        e = ksi * np.exp(alpha * x**beta)
        some = np.where(alpha == 0, 1.0, alpha)
        toe = np.where(alpha == 0, ksi * x**beta / beta, (e - ksi) / (some * beta))
        root = np.sqrt(np.maximum(In, I0))
        W = toe + b * (root**2 - I0) - E * (root - lam0)
        low = In < I0
        W1 = np.where(low, e * x ** (beta - 1), b - 0.5 * E / root)
        W2 = np.where(low, e * x ** (beta - 2) * (beta - 1 + alpha * beta * x**beta), 0.25 * E / root**3)
        return In >= 1.0, W, W1, W2


@variable_record
class FiberNaturalNeoHookean(_Law, Fiber):
    """W = ksi ln(l/lam0)^2 / 2 for l > lam0."""

    ksi: Number = 0.0
    lam0: Number = 1.0
    parameters = ("ksi", "lam0")

    def law(self, pts: Points, In: Floats) -> tuple[NDArray[np.bool_], Floats, Floats, Floats]:
        ksi, lam0 = self.columns(pts)
        x = 0.5 * np.log(In) - np.log(lam0)
        return x > np.finfo(float).eps, 0.5 * ksi * x**2, 0.5 * ksi * x / In, ksi * (0.25 - 0.5 * x) / In**2


@variable_record
class FiberKiousisUncoupled(_Law, UncoupledFiber):
    """W~ = d1 (In~ - d2)^n / n for In~ > d2. Kiousis et al., J. Biomech. Eng. 131 (2009) 121002."""

    d1: Number = 0.0
    d2: Number = 0.0
    n: Number = 2.0
    parameters = ("d1", "d2", "n")

    def law(self, pts: Points, In: Floats) -> tuple[NDArray[np.bool_], Floats, Floats, Floats]:
        d1, d2, n = self.columns(pts)
        x = np.maximum(In - d2, 0.0)
        return In >= d2, d1 / n * x**n, d1 * x ** (n - 1), d1 * (n - 1) * x ** (n - 2)


for _table in ("solid", "fiber"):
    register(FiberNeoHookean, "fiber-NH", _table)
    register(FiberNeoHookeanUncoupled, "fiber-NH-uncoupled", _table)
    register(FiberPower, "fiber-pow", _table)
    register(FiberExpPowLinear, "fiber-exp-pow-linear", _table)
    register(FiberNaturalNeoHookean, "fiber-natural-NH", _table)
register(FiberKiousisUncoupled, "fiber-Kiousis-uncoupled")
