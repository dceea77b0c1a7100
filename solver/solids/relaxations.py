"""Relaxation functions of breaking bonds: g(t) from 1 down, given the time since breaking began.

A record is called with points, t (n, m), the distortion K2 (n, m) at which each generation formed, and the
magnitude of the rate of deformation (n, 1). Ateshian, J. Biomech. 48 (2015) 941.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from ..points import Points
from ..record import variable_record
from ..special import expi, gamma, gammaincc, k1
from ..values import as_value
from .base import Floats, Number, Property
from .registry import register

Curve = Callable[[Floats], Floats]


@variable_record
class Relaxation:
    """g(t)."""

    parameters: ClassVar[tuple[str, ...]] = ()
    options: ClassVar[tuple[str, ...]] = ()
    properties: ClassVar[dict[str, Property]] = {}
    rated: ClassVar[bool] = False  # the rate of deformation matters
    formed: ClassVar[bool] = False  # the distortion at which bonds formed matters

    def p(self, name: str, pts: Points) -> Floats:
        """A parameter as (1|n, 1)."""
        return as_value(getattr(self, name))(pts.t, pts.X, pts.e)[:, None]

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        raise NotImplementedError


@variable_record
class Exponential(Relaxation):
    """exp(-t/tau)."""

    tau: Number = 0.0
    parameters = ("tau",)

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return np.exp(-t / self.p("tau", pts))


@variable_record
class ExponentialDistortion(Relaxation):
    """exp(-t/tau), tau = tau0 + tau1 K2^alpha."""

    tau0: Number = 0.0
    tau1: Number = 0.0
    alpha: Number = 1.0
    parameters = ("tau0", "tau1", "alpha")
    formed = True

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return np.exp(-t / (self.p("tau0", pts) + self.p("tau1", pts) * K2 ** self.p("alpha", pts)))


@variable_record
class ExponentialUser(Relaxation):
    """exp(-t/tau(K2))."""

    tau: Curve | None = None
    properties = {"tau": Property("curve")}
    formed = True

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return np.exp(-t / self.tau(K2))  # type: ignore[misc]


@variable_record
class Fung(Relaxation):
    """Continuous box spectrum between tau1 and tau2 (Fung, Biomechanics, section 7.6).

    FEBio 4.11 sums Ei(x) by its power series down to x = -34, where that keeps no digit: long after bonds began to
    break its g is off by up to 1e-3 (model ma35 of its test suite; with its Ei our answer is its own to 3e-15).
    """

    tau1: Number = 0.0
    tau2: Number = 0.0
    parameters = ("tau1", "tau2")

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        a, b = self.p("tau1", pts), self.p("tau2", pts)
        x = np.where(t > 0, t, 1.0)
        g = b * np.exp(-x / b) - a * np.exp(-x / a) + x * (expi(-x / b) - expi(-x / a))
        return np.where(t > 0, np.maximum(g / (b - a), 0.0), 1.0)


@variable_record
class Park(Relaxation):
    """1 / (1 + (t/tau)^beta)."""

    tau: Number = 0.0
    beta: Number = 0.0
    parameters = ("tau", "beta")

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return 1.0 / (1.0 + (t / self.p("tau", pts)) ** self.p("beta", pts))


@variable_record
class _Distortion(Relaxation):
    tau0: Number = 0.0
    tau1: Number = 0.0
    beta0: Number = 0.0
    beta1: Number = 0.0
    alpha: Number = 1.0
    parameters = ("tau0", "tau1", "beta0", "beta1", "alpha")
    formed = True

    def _both(self, pts: Points, K2: Floats) -> tuple[Floats, Floats]:
        k = K2 ** self.p("alpha", pts)
        tau = self.p("tau0", pts) + self.p("tau1", pts) * k
        return tau, self.p("beta0", pts) + self.p("beta1", pts) * k


@variable_record
class ParkDistortion(_Distortion):
    """:class:`Park` with tau0 + tau1 K2^alpha and beta0 + beta1 K2^alpha."""

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        tau, beta = self._both(pts, K2)
        return 1.0 / (1.0 + (t / tau) ** beta)


@variable_record
class ParkUser(Relaxation):
    """:class:`Park` with curves tau(K2), beta(K2)."""

    tau: Curve | None = None
    beta: Curve | None = None
    properties = {"tau": Property("curve"), "beta": Property("curve")}
    formed = True

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return 1.0 / (1.0 + (t / self.tau(K2)) ** self.beta(K2))  # type: ignore[misc]


@variable_record
class Power(Relaxation):
    """(1 + t/tau)^-beta."""

    tau: Number = 0.0
    beta: Number = 0.0
    parameters = ("tau", "beta")

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return (1.0 + t / self.p("tau", pts)) ** -self.p("beta", pts)


@variable_record
class PowerDistortion(_Distortion):
    """:class:`Power` with tau0 + tau1 K2^alpha and beta0 + beta1 K2^alpha."""

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        tau, beta = self._both(pts, K2)
        return (1.0 + t / tau) ** -beta


@variable_record
class PowerUser(Relaxation):
    """:class:`Power` with curves tau(K2), beta(K2)."""

    tau: Curve | None = None
    beta: Curve | None = None
    properties = {"tau": Property("curve"), "beta": Property("curve")}
    formed = True

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return (1.0 + t / self.tau(K2)) ** -self.beta(K2)  # type: ignore[misc]


@variable_record
class Carreau(Relaxation):
    """exp(-t/tau), tau = tau0 (1 + (lambda gamma')^2)^((n-1)/2), gamma' = 2^1/2 |D|."""

    tau0: Number = 0.0
    lambda_: Number = 0.0
    n: Number = 1.0
    parameters = ("tau0", "lambda_", "n")
    rated = True

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        shear = self.p("lambda_", pts) * np.sqrt(2.0) * rate
        tau = self.p("tau0", pts) * (1.0 + shear**2) ** (0.5 * (self.p("n", pts) - 1.0))
        return np.exp(-t / tau)


@variable_record
class Prony(Relaxation):
    """sum g_i exp(-t/t_i) / sum g_i."""

    t1: Number = 1.0
    t2: Number = 1.0
    t3: Number = 1.0
    t4: Number = 1.0
    t5: Number = 1.0
    t6: Number = 1.0
    g1: Number = 0.0
    g2: Number = 0.0
    g3: Number = 0.0
    g4: Number = 0.0
    g5: Number = 0.0
    g6: Number = 0.0
    parameters = ("t1", "t2", "t3", "t4", "t5", "t6", "g1", "g2", "g3", "g4", "g5", "g6")

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        g = [self.p(f"g{i}", pts) for i in range(1, 7)]
        return np.asarray(sum(gi * np.exp(-t / self.p(f"t{i}", pts)) for i, gi in enumerate(g, 1)) / sum(g))


def malkin(t: Floats, tau1: Floats, tau2: Floats, beta: Floats) -> Floats:
    """Power-law spectrum between tau1 and tau2 (Malkin, Rheol. Acta 45 (2006) 775)."""
    x, b = np.where(t > 0, t, 1.0), np.where(beta == 1, 1.5, beta - 1.0)
    p = np.where(b > 0, b, 0.5)
    Q = (gammaincc(p, x / tau2) - gammaincc(p, x / tau1)) * gamma(p)
    power = np.where(b > 0, p * x**-p * Q / (tau1**-p - tau2**-p), 0.0)  # beta < 1: all at once, as in FEBio
    ratio = np.where(tau1 == tau2, 2.0, tau1 / tau2)
    g = np.where(beta == 1, (expi(-x / tau2) - expi(-x / tau1)) / np.log(ratio), power)
    return np.where(t > 0, g, 1.0)


@variable_record
class Malkin(Relaxation):
    """:func:`malkin`."""

    tau1: Number = 0.0
    tau2: Number = 0.0
    beta: Number = 0.0
    parameters = ("tau1", "tau2", "beta")

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return malkin(t, self.p("tau1", pts), self.p("tau2", pts), self.p("beta", pts))


@variable_record
class MalkinDistortion(Relaxation):
    """:func:`malkin` with tau_i = t_i c0 + t_i c1 exp(-K2 / t_i s0)."""

    t1c0: Number = 0.0
    t1c1: Number = 0.0
    t1s0: Number = 1.0
    t2c0: Number = 0.0
    t2c1: Number = 0.0
    t2s0: Number = 1.0
    beta: Number = 1.0
    parameters = ("t1c0", "t1c1", "t1s0", "t2c0", "t2c1", "t2s0", "beta")
    formed = True

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        tau = [
            self.p(f"{k}c0", pts) + self.p(f"{k}c1", pts) * np.exp(-K2 / self.p(f"{k}s0", pts))
            for k in ("t1", "t2")
        ]
        return malkin(t, tau[0], tau[1], self.p("beta", pts))


@variable_record
class MalkinUser(Relaxation):
    """:func:`malkin` with curves tau1(K2), tau2(K2), beta(K2)."""

    tau1: Curve | None = None
    tau2: Curve | None = None
    beta: Curve | None = None
    properties = {"tau1": Property("curve"), "tau2": Property("curve"), "beta": Property("curve")}
    formed = True

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return malkin(t, self.tau1(K2), self.tau2(K2), self.beta(K2))  # type: ignore[misc]


def exponential_spectrum(t: Floats, tau: Floats) -> Floats:
    """x K1(x), x = 2 (t/tau)^1/2, K1 the modified Bessel function."""
    x = 2.0 * np.sqrt(np.where(t > 0, t, 1.0) / tau)
    return np.where(t > 0, x * k1(x), 1.0)


@variable_record
class ExponentialSpectrum(Relaxation):
    """:func:`exponential_spectrum`."""

    tau: Number = 0.0
    parameters = ("tau",)

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return exponential_spectrum(t, self.p("tau", pts))


@variable_record
class ExponentialSpectrumUser(Relaxation):
    """:func:`exponential_spectrum` with a curve tau(K2)."""

    tau: Curve | None = None
    properties = {"tau": Property("curve")}
    formed = True

    def __call__(self, pts: Points, t: Floats, K2: Floats, rate: Floats) -> Floats:
        return exponential_spectrum(t, self.tau(K2))  # type: ignore[misc]


register(Exponential, "relaxation-exponential", "relaxation")
register(ExponentialDistortion, "relaxation-exp-distortion", "relaxation")
register(ExponentialUser, "relaxation-exp-dist-user", "relaxation")
register(Fung, "relaxation-Fung", "relaxation")
register(Park, "relaxation-Park", "relaxation")
register(ParkDistortion, "relaxation-Park-distortion", "relaxation")
register(ParkUser, "relaxation-Park-dist-user", "relaxation")
register(Power, "relaxation-power", "relaxation")
register(PowerDistortion, "relaxation-power-distortion", "relaxation")
register(PowerUser, "relaxation-power-dist-user", "relaxation")
register(Carreau, "relaxation-Carreau", "relaxation")
register(Prony, "relaxation-Prony", "relaxation")
register(Malkin, "relaxation-Malkin", "relaxation")
register(MalkinDistortion, "relaxation-Malkin-distortion", "relaxation")
register(MalkinUser, "relaxation-Malkin-dist-user", "relaxation")
register(ExponentialSpectrum, "relaxation-CSexp", "relaxation")
register(ExponentialSpectrumUser, "relaxation-CSexp-dist-user", "relaxation")
