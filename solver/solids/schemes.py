"""Quadrature over the directions of a sphere or circle."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import ClassVar

import numpy as np

from ..kernels.directions import span
from ..kernels.ordered_spectra import ordered_spectra
from ..matrices import eigh
from ..record import variable_record
from .base import Floats, Property
from .registry import register

_SIZES = (20, 34, 60, 74, 196, 210, 396, 410, 596, 610, 796, 810, 996, 1010, 1196, 1210, 1396, 1410, 1596, 1610, 1796)


@lru_cache(maxsize=None)
def _stored(name: str) -> Floats:
    """Rows (angle theta, angle phi, area) of a triangulation, or (abscissa, weight) of a Kronrod rule.

    Numbers of FEBio's rules (triangulations, geodesic domes, Gauss-Kronrod-Trefethen-Patterson).
    """
    with np.load(Path(__file__).with_name("sphere_rules.npz")) as z:
        return z[name]  # type: ignore[no-any-return]


def _of_angles(rule: Floats) -> tuple[Floats, Floats]:
    t, p, w = rule
    N = np.stack((np.cos(t) * np.sin(p), np.sin(t) * np.sin(p), np.cos(p)), axis=1)
    return np.ascontiguousarray(N[None]), np.ascontiguousarray(w[None])


@variable_record
class Scheme:
    """``whole()`` gives directions (1, m, 3) and weights (1, m) over all of the sphere or circle; ``taut(C)`` those
    that FEBio sums for right Cauchy-Green tensors ``C`` (n, 3, 3), (1|n, m, 3) and (1|n, m)."""

    parameters: ClassVar[tuple[str, ...]] = ()
    options: ClassVar[tuple[str, ...]] = ()
    properties: ClassVar[dict[str, Property]] = {}

    def whole(self) -> tuple[Floats, Floats]:
        raise NotImplementedError

    def taut(self, C: Floats) -> tuple[Floats, Floats]:
        return self.whole()


@variable_record
class Triangles(Scheme):
    """Areas and centres of a triangulation of the sphere."""

    resolution: int = 796
    options = ("resolution",)

    def whole(self) -> tuple[Floats, Floats]:
        n = int(self.resolution)
        return _of_angles(_stored(f"triangles_{n if n > 21 else _SIZES[n]}"))


@variable_record
class Geodesic(Scheme):
    """A geodesic dome of 320 (resolution 0) or 1280 (1) triangles."""

    resolution: int = 0
    options = ("resolution",)

    def whole(self) -> tuple[Floats, Floats]:
        return _of_angles(_stored("geodesic_high" if self.resolution else "geodesic_low"))


@variable_record
class Trapezoidal(Scheme):
    """``nth`` equal steps over half the circle in the plane of the first two axes."""

    nth: int = 12
    options = ("nth",)

    def whole(self) -> tuple[Floats, Floats]:
        t = np.arange(int(self.nth)) * np.pi / int(self.nth)
        N = np.stack((np.cos(t), np.sin(t), 0.0 * t), axis=1)
        return N[None], np.full((1, len(t)), 2.0 * np.pi / len(t))


@variable_record
class _Taut(Scheme):
    """Trapezoidal in theta and a one-dimensional rule in cos(phi), only over the directions in tension.

    Half the sphere, counted twice. Axes are the principal directions of strain.
    """

    nph: int = 7
    nth: int = 31
    options = ("nph", "nth")
    _least: ClassVar[float]  # largest strain up to which nothing is in tension
    _eps: ClassVar[float]
    _floor: ClassVar[float]

    def rule(self) -> tuple[Floats, Floats]:
        raise NotImplementedError

    def axes(self, E: Floats) -> tuple[Floats, Floats]:
        """Principal strains (n, 3), ascending, and directions (n, 3, 3; columns) by the method that FEBio takes, whose
        signs and choice among equal strains the rule depends on."""
        raise NotImplementedError

    def _span(self, V: Floats, lo: Floats, hi: Floats) -> tuple[Floats, Floats]:
        """Directions from axes V (k, 3, 3) and limits (k, nth) of cos(phi)."""
        x, w = self.rule()
        nth = int(self.nth)
        t = np.arange(nth) * 2.0 * np.pi / nth
        N, weight = np.empty((len(V), nth * len(x), 3)), np.empty((len(V), nth * len(x)))
        span(
            np.ascontiguousarray(V), np.ascontiguousarray(lo), np.ascontiguousarray(hi), np.cos(t), np.sin(t),
            np.ascontiguousarray(x), np.ascontiguousarray(w), 4.0 * np.pi / nth, N, weight,
        )  # fmt: skip
        return N, weight

    def whole(self) -> tuple[Floats, Floats]:
        nth = int(self.nth)
        return self._span(np.eye(3)[None], np.zeros((1, nth)), np.ones((1, nth)))

    def taut(self, C: Floats) -> tuple[Floats, Floats]:
        l, V = self.axes(0.5 * (C - np.eye(3)))
        slack, cone = l[:, 2] <= self._least, (l[:, 1] <= self._eps) & (l[:, 0] < 0)
        belt = (l[:, 0] < self._floor) & ~cone & ~slack
        l[belt], V[belt] = l[belt][:, ::-1], V[belt][:, :, ::-1]
        t = np.arange(int(self.nth)) * 2.0 * np.pi / int(self.nth)
        a = l[:, :1] * np.cos(t) ** 2 + l[:, 1:2] * np.sin(t) ** 2
        d = a - l[:, 2:]
        with np.errstate(divide="ignore", invalid="ignore"):
            q = np.sqrt(np.where(d == 0, 1.0, np.clip(a / np.where(d == 0, 1.0, d), 0.0, None)))
        lo = np.where(cone[:, None], np.minimum(q, 1.0), 0.0)
        hi = np.where(belt[:, None], np.minimum(q, 1.0), 1.0)
        hi = np.where(slack[:, None], lo, hi)
        return self._span(V, lo, hi)


@variable_record
class Gauss(_Taut):
    """Gauss-Legendre in cos(phi)."""

    nph: int = 5
    nth: int = 10
    _least, _eps, _floor = 0.5e-9, 0.5e-9, 0.5e-9

    def axes(self, E: Floats) -> tuple[Floats, Floats]:
        return eigh(E)

    def rule(self) -> tuple[Floats, Floats]:
        return np.polynomial.legendre.leggauss(int(self.nph))


@variable_record
class Kronrod(_Taut):
    """Gauss-Kronrod-Trefethen rule in cos(phi): ``nph`` of 7, 11, 15, 19, 23 or 27.

    All directions count at rest, where rounding decides in FEBio: the first tangent has the stiffness of fibers.
    """

    _least, _eps, _floor = -np.finfo(float).tiny, 2.220446049250313e-16, 0.0

    def axes(self, E: Floats) -> tuple[Floats, Floats]:
        l, V = np.empty((len(E), 3)), np.empty((len(E), 3, 3))
        ordered_spectra(E, l, V)
        return l, V

    def rule(self) -> tuple[Floats, Floats]:
        x, w = _stored(f"kronrod_{int(self.nph)}")
        return x, w


register(Triangles, "fibers-3d-fei", "scheme")
register(Geodesic, "fibers-3d-geodesic", "scheme")
register(Trapezoidal, "fibers-2d-trapezoidal", "scheme")
register(Gauss, "fibers-3d-gauss", "scheme")
register(Kronrod, "fibers-3d-gkt", "scheme")
