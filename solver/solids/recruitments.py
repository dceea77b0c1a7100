"""Recruitment of weak bonds: by what a new generation outweighs the first, given the strain when it forms.

A record is called with points and the measure X (n,) of the strain that triggers generations.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from ..points import Points
from ..record import variable_record
from ..values import as_value
from .base import Floats, Number, Property
from .distribution_functions import DistributionFunction, Gamma, LogNormal, Quintic, Weibull
from .registry import register


@variable_record
class Recruitment:
    """r(X); none of these recruits without strain, X = 0."""

    parameters: ClassVar[tuple[str, ...]] = ()
    options: ClassVar[tuple[str, ...]] = ()
    properties: ClassVar[dict[str, Property]] = {}

    def p(self, name: str, pts: Points) -> Floats:
        """A parameter (1|n,)."""
        return as_value(getattr(self, name))(pts.t, pts.X, pts.e)

    def __call__(self, pts: Points, X: Floats) -> Floats:
        raise NotImplementedError


@variable_record
class Power(Recruitment):
    """mu0 + mu1 (X/scale)^alpha."""

    alpha: Number = 2.0
    mu0: Number = 1.0
    mu1: Number = 0.0
    scale: Number = 1.0
    parameters = ("alpha", "mu0", "mu1", "scale")

    def __call__(self, pts: Points, X: Floats) -> Floats:
        x = np.maximum(X, 0.0) / self.p("scale", pts)
        return np.where(X > 0, self.p("mu0", pts) + self.p("mu1", pts) * x ** self.p("alpha", pts), 0.0)


@variable_record
class Exponential(Recruitment):
    """mu0 exp(mu1 (X/scale)^alpha)."""

    alpha: Number = 1.0
    mu0: Number = 1.0
    mu1: Number = 0.0
    scale: Number = 1.0
    parameters = ("alpha", "mu0", "mu1", "scale")

    def __call__(self, pts: Points, X: Floats) -> Floats:
        x = np.maximum(X, 0.0) / self.p("scale", pts)
        return np.where(X > 0, self.p("mu0", pts) * np.exp(self.p("mu1", pts) * x ** self.p("alpha", pts)), 0.0)


@variable_record
class Polynomial(Recruitment):
    """mu0 + mu1 X + mu2 X^2."""

    mu0: Number = 1.0
    mu1: Number = 0.0
    mu2: Number = 0.0
    parameters = ("mu0", "mu1", "mu2")

    def __call__(self, pts: Points, X: Floats) -> Floats:
        mu0, mu1, mu2 = (self.p(n, pts) for n in self.parameters)
        return np.where(X > 0, mu0 + mu1 * X + mu2 * X * X, 0.0)


@variable_record
class User(Recruitment):
    """A curve."""

    function: Callable[[Floats], Floats] | None = None
    properties = {"function": Property("curve")}

    def __call__(self, pts: Points, X: Floats) -> Floats:
        return np.asarray(self.function(X))  # type: ignore[misc]


@variable_record
class _Distributed(DistributionFunction):
    """1 + max times the cumulative distribution."""

    max: Number = 0.0

    def __call__(self, pts: Points, X: Floats) -> Floats:
        return 1.0 + self.p("max", pts, X) * self.cdf(pts, X)


@variable_record
class DistributedLogNormal(_Distributed, LogNormal):
    """1 + max erfc(-ln(X/mu) / (sigma sqrt 2)) / 2."""

    parameters = ("mu", "sigma", "max")


@variable_record
class DistributedWeibull(_Distributed, Weibull):
    """1 + max (1 - exp(-((X - ploc)/mu)^alpha)), 0 up to ploc."""

    parameters = ("alpha", "mu", "ploc", "max")

    def __call__(self, pts: Points, X: Floats) -> Floats:
        return np.where(self.p("ploc", pts, X) < X, super().__call__(pts, X), 0.0)


@variable_record
class DistributedQuintic(_Distributed, Quintic):
    """1 + max x^3 (10 - 15 x + 6 x^2), x = (X - mumin)/(mumax - mumin) between 0 and 1."""

    parameters = ("mumin", "mumax", "max")


@variable_record
class DistributedGamma(_Distributed, Gamma):
    """1 + max P(alpha, X/mu), the regularised lower incomplete gamma function."""

    parameters = ("alpha", "mu", "max")


register(Power, "recruitment power", "recruitment")
register(Exponential, "recruitment exponential", "recruitment")
register(Polynomial, "recruitment polynomial", "recruitment")
register(User, "recruitment user", "recruitment")
register(DistributedLogNormal, "recruitment log-normal", "recruitment")
register(DistributedWeibull, "recruitment Weibull", "recruitment")
register(DistributedQuintic, "recruitment quintic", "recruitment")
register(DistributedGamma, "recruitment gamma", "recruitment")
