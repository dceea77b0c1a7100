"""Cumulative distributions of the thresholds at which bonds fail (damage) or yield."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import ClassVar

import numpy as np

from ..points import Points
from ..record import variable_record
from ..special import erfc, gamma, gammainc
from ..values import as_value
from .base import Floats, Number, Property
from .registry import register


@variable_record
class DistributionFunction:
    """``cdf(pts, X)`` of X (n,) or (n, m); ``damage`` is Dmax times it."""

    Dmax: Number = field(default=1.0, kw_only=True)
    parameters: ClassVar[tuple[str, ...]] = ("Dmax",)
    options: ClassVar[tuple[str, ...]] = ()
    properties: ClassVar[dict[str, Property]] = {}

    def p(self, name: str, pts: Points, X: Floats) -> Floats:
        """A parameter, shaped to go with X."""
        return as_value(getattr(self, name))(pts.t, pts.X, pts.e).reshape((-1,) + (1,) * (X.ndim - 1))

    def cdf(self, pts: Points, X: Floats) -> Floats:
        raise NotImplementedError

    def pdf(self, pts: Points, X: Floats) -> Floats:
        raise NotImplementedError

    def damage(self, pts: Points, X: Floats) -> Floats:
        return self.p("Dmax", pts, X) * self.cdf(pts, X)


@variable_record
class Simo(DistributionFunction):
    """(1 - b)(1 - a (1 - exp(-X/a)) / X): Simo, Comput. Methods Appl. Mech. Eng. 60 (1987) 153."""

    a: Number = 0.0
    b: Number = 0.0
    parameters = ("Dmax", "a", "b")

    def cdf(self, pts: Points, X: Floats) -> Floats:
        a, b = self.p("a", pts, X), self.p("b", pts, X)
        x, some = np.maximum(X, 1e-12), np.where(a == 0, 1.0, a)
        far = (1 - b) * (1 - (1 - np.exp(-x / some)) * some / x)
        near = 0.5 * (1 - b) / some * X
        return np.where((X < 0) | (a == 0), 0.0, np.where(X > 1e-12, far, near))

    def pdf(self, pts: Points, X: Floats) -> Floats:
        a, b = self.p("a", pts, X), self.p("b", pts, X)
        x, some = np.maximum(X, 1e-12), np.where(a == 0, 1.0, a)
        far = (1 - b) * (some - (some + x) * np.exp(-x / some)) / x**2
        near = (1 - b) / some * (0.5 - X / 3 / some)
        return np.where((X < 0) | (a == 0), 0.0, np.where(X > 1e-12, far, near))


@variable_record
class LogNormal(DistributionFunction):
    """erfc(-ln(X/mu) / (sigma sqrt 2)) / 2."""

    mu: Number = 1.0
    sigma: Number = 1.0
    parameters = ("Dmax", "mu", "sigma")

    def cdf(self, pts: Points, X: Floats) -> Floats:
        mu, sigma = self.p("mu", pts, X), self.p("sigma", pts, X)
        x = np.where(X > 0, X, 1.0)
        return np.where(X > 0, 0.5 * erfc(-np.log(x / mu) / sigma / np.sqrt(2.0)), 0.0)

    def pdf(self, pts: Points, X: Floats) -> Floats:
        mu, sigma = self.p("mu", pts, X), self.p("sigma", pts, X)
        x = np.where(X > 1e-12, X, 1.0)
        g = np.exp(-0.5 * (np.log(x / mu) / sigma) ** 2) / (np.sqrt(2 * np.pi) * x * sigma)
        return np.where(X > 1e-12, g, 0.0)


@variable_record
class Weibull(DistributionFunction):
    """1 - exp(-((X - ploc)/mu)^alpha)."""

    alpha: Number = 1.0
    mu: Number = 1.0
    ploc: Number = 0.0
    parameters = ("Dmax", "alpha", "mu", "ploc")

    def cdf(self, pts: Points, X: Floats) -> Floats:
        x = np.maximum(X - self.p("ploc", pts, X), 0.0)
        return -np.expm1(-((x / self.p("mu", pts, X)) ** self.p("alpha", pts, X)))

    def pdf(self, pts: Points, X: Floats) -> Floats:
        alpha, mu = self.p("alpha", pts, X), self.p("mu", pts, X)
        x = np.maximum(X - self.p("ploc", pts, X), 0.0)
        g = np.exp(-((x / mu) ** alpha)) * alpha * x ** np.maximum(alpha - 1, 0.0) / mu**alpha
        return np.where((x > 0) & (alpha >= 1), g, 0.0)


@variable_record
class Step(DistributionFunction):
    """0 up to mu, 1 beyond."""

    mu: Number = 1.0
    parameters = ("Dmax", "mu")

    def cdf(self, pts: Points, X: Floats) -> Floats:
        return np.where(self.p("mu", pts, X) < X, 1.0, 0.0)

    def pdf(self, pts: Points, X: Floats) -> Floats:
        return np.where(self.p("mu", pts, X) == X, 1.0, 0.0)


@variable_record
class Quintic(DistributionFunction):
    """x^3 (10 - 15 x + 6 x^2), x = (X - mumin)/(mumax - mumin) between 0 and 1."""

    mumin: Number = 0.0
    mumax: Number = 1.0
    parameters = ("Dmax", "mumin", "mumax")

    def _x(self, pts: Points, X: Floats) -> Floats:
        a, b = self.p("mumin", pts, X), self.p("mumax", pts, X)
        return np.clip((X - a) / (b - a), 0.0, 1.0)

    def cdf(self, pts: Points, X: Floats) -> Floats:
        x = self._x(pts, X)
        return x**3 * (10 - 15 * x + 6 * x * x)

    def pdf(self, pts: Points, X: Floats) -> Floats:
        x = self._x(pts, X)
        return 30 * (x * (x - 1)) ** 2


@variable_record
class Gamma(DistributionFunction):
    """Regularised lower incomplete gamma function P(alpha, X/mu)."""

    alpha: Number = 2.0
    mu: Number = 4.0
    parameters = ("Dmax", "alpha", "mu")

    def cdf(self, pts: Points, X: Floats) -> Floats:
        return gammainc(self.p("alpha", pts, X), np.maximum(X, 0.0) / self.p("mu", pts, X))

    def pdf(self, pts: Points, X: Floats) -> Floats:
        a, mu = self.p("alpha", pts, X), self.p("mu", pts, X)
        x = np.where(X > 0, X, 1.0) / mu
        return np.where(X > 0, x ** (a - 1) * np.exp(-x) / mu / gamma(a), 0.0)


@variable_record
class User(DistributionFunction):
    """A curve."""

    cdf_: Callable[[Floats], Floats] | None = None
    parameters = ("Dmax",)
    properties = {"cdf_": Property("curve")}

    def cdf(self, pts: Points, X: Floats) -> Floats:
        return self.cdf_(X)  # type: ignore[misc]


register(Simo, "CDF Simo", "cdf")
register(LogNormal, "CDF log-normal", "cdf")
register(Weibull, "CDF Weibull", "cdf")
register(Step, "CDF step", "cdf")
register(Quintic, "CDF quintic", "cdf")
register(Gamma, "CDF gamma", "cdf")
register(User, "CDF user", "cdf")
