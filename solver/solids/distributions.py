"""Angular densities of fiber directions; not normalised, since the sum over directions is divided out."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ..points import Points
from ..record import variable_record
from ..values import as_value
from .base import Floats, Number, Property
from .registry import register
from .voigt import matrix


@variable_record
class Distribution:
    """Density R(N) of unit vectors ``N`` (1|n, m, 3) in local axes, as (1|n, m)."""

    parameters: ClassVar[tuple[str, ...]] = ()
    vectors: ClassVar[dict[str, int]] = {}
    options: ClassVar[tuple[str, ...]] = ()
    properties: ClassVar[dict[str, Property]] = {}

    def value(self, name: str, pts: Points) -> Floats:
        """A parameter as (1|n, 1)."""
        return as_value(getattr(self, name))(pts.t, pts.X, pts.e)[:, None]

    def __call__(self, pts: Points, N: Floats) -> Floats:
        raise NotImplementedError


@variable_record
class Spherical(Distribution):
    """R = 1: all directions alike."""

    def __call__(self, pts: Points, N: Floats) -> Floats:
        return np.ones(N.shape[:2])


@variable_record
class Circular(Spherical):
    """R = 1 in the plane."""


@variable_record
class Ellipsoidal(Distribution):
    """R = (sum N_i^2 / spa_i^2)^-1/2."""

    spa: Any = (1.0, 1.0, 1.0)
    parameters = ("spa",)
    vectors = {"spa": 3}

    def __call__(self, pts: Points, N: Floats) -> Floats:
        a = [as_value(x)(pts.t, pts.X, pts.e)[:, None] for x in self.spa]
        return sum((N[..., k] / a[k]) ** 2 for k in range(3)) ** -0.5  # type: ignore[operator, return-value]


@variable_record
class Elliptical(Distribution):
    """R = (N_1^2 / spa1^2 + N_2^2 / spa2^2)^-1/2."""

    spa1: Number = 1.0
    spa2: Number = 1.0
    parameters = ("spa1", "spa2")

    def __call__(self, pts: Points, N: Floats) -> Floats:
        a, b = self.value("spa1", pts), self.value("spa2", pts)
        return ((N[..., 0] / a) ** 2 + (N[..., 1] / b) ** 2) ** -0.5


@variable_record
class VonMises(Distribution):
    """R = exp[b (2 N_1^2 - 1)]: gathered about the first axis."""

    b: Number = 0.0
    parameters = ("b",)

    def __call__(self, pts: Points, N: Floats) -> Floats:
        return np.exp(self.value("b", pts) * (2.0 * N[..., 0] ** 2 - 1.0))


@variable_record
class VonMisesPlane(VonMises):
    """The density of :class:`VonMises` in the plane."""


@variable_record
class TwoVonMises(Distribution):
    """Two cones at angles +-gamma from the first axis."""

    b: Number = 0.0
    cosg: Number = 1.0
    parameters = ("b", "cosg")

    def __call__(self, pts: Points, N: Floats) -> Floats:
        b, c = self.value("b", pts), self.value("cosg", pts)
        x = N[..., 0]
        sines = np.sqrt(np.maximum(1.0 - x * x, 0.0)) * np.sqrt(1.0 - c * c)
        return np.exp(b * (2 * (x * c - sines) ** 2 - 1)) + np.exp(b * (2 * (x * c + sines) ** 2 - 1))


@variable_record
class StructureTensor(Distribution):
    """R = N . spd N, spd symmetric in Voigt order."""

    spd: Any = (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)
    parameters = ("spd",)
    vectors = {"spd": 6}

    def __call__(self, pts: Points, N: Floats) -> Floats:
        cols = np.broadcast_arrays(*(as_value(v)(pts.t, pts.X, pts.e) for v in self.spd))
        M = matrix(np.stack(cols, axis=-1))
        return np.einsum("nmi,nij,nmj->nm", N, M, N)


register(Spherical, "spherical", "distribution")
register(Circular, "circular", "distribution")
register(Ellipsoidal, "ellipsoidal", "distribution")
register(Elliptical, "elliptical", "distribution")
register(VonMises, "von-Mises-3d", "distribution")
register(VonMisesPlane, "von-Mises-2d", "distribution")
register(TwoVonMises, "von-Mises-3d-two-axisym", "distribution")
register(StructureTensor, "structure-tensor", "distribution")
