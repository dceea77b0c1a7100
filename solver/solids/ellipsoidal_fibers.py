"""Fibers in all directions whose modulus and exponent follow an ellipsoid, alone or within a matrix."""

from __future__ import annotations

from dataclasses import field
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from ..kernels.fibers import add_power_fibers, squared_stretch
from ..points import Points
from ..record import variable_record
from .base import Floats, Number, Solid, wanted
from .mooney_rivlin import MooneyRivlin
from .neo_hookean import NeoHookean
from .registry import register
from .schemes import _of_angles, _stored
from .uncoupled import Uncoupled
from .veronda_westmann import VerondaWestmann

_NO_AXES = np.empty((0, 3, 3))
_SIGNS = np.array([[1, 1, 1], [-1, 1, 1], [-1, -1, 1], [1, -1, 1]], dtype=float)


def _octants() -> tuple[Floats, Floats]:
    """45 directions of an octant in four of them, doubled: (180, 3) and weights (180,)."""
    rule = _stored("octant")
    N = (_SIGNS[:, None, :] * rule[None, :, :3]).reshape(-1, 3)
    return N, np.tile(2.0 * rule[:, 3], 4)


@lru_cache(maxsize=1)
def _dome() -> tuple[Floats, Floats]:
    """A geodesic dome over the whole sphere: (320, 3) and weights (320,)."""
    N, w = _of_angles(_stored("geodesic_low"))
    return N[0], w[0]


@variable_record
class _Ellipsoidal(Solid):
    """W = sum_j w_j ksi(N_j) (In_j - 1)^beta(N_j) over directions in tension, 1/ksi^2 = sum N_i^2 / ksi_i^2.

    Ateshian, Rajan, Chahine, Canal & Hung, J. Biomech. Eng. 131 (2009) 061003.
    """

    beta: Any = (2.0, 2.0, 2.0)
    ksi: Any = (0.0, 0.0, 0.0)
    parameters: ClassVar[tuple[str, ...]] = ("beta", "ksi")
    vectors: ClassVar[dict[str, int]] = {"beta": 3, "ksi": 3}
    iso = False
    dome = False
    _uniform: tuple[Floats, Floats, Floats, Floats] | None = field(default=None, init=False, repr=False)

    def _family(self, pts: Points) -> tuple[Floats, Floats, Floats, Floats]:
        """Directions (1|n, m, 3), weights (m,), and ksi and beta (1|n, m)."""
        Q = self.inner(pts).Q
        constant = Q is None and all(v.constant for v in (*self.ksi, *self.beta))
        if constant and self._uniform is not None:
            return self._uniform
        N, w = _dome() if self.dome else _octants()
        if self.dome:  # directions are global, the ellipsoid is local
            A, local = N[None], N[None] if Q is None else N[None] @ Q
        else:
            A, local = N[None] if Q is None else N[None] @ np.swapaxes(Q, 1, 2), N[None]

        def radius(name: str) -> Floats:
            axes = self.vector(name, pts)[:, None, :]
            with np.errstate(divide="ignore"):
                return np.ascontiguousarray(((local / axes) ** 2).sum(2) ** -0.5)

        family = np.ascontiguousarray(A), w, radius("ksi"), radius("beta")
        if constant:
            self._uniform = family
        return family

    def fibers(self, pts: Points, s: Floats, c: Floats | None) -> None:
        Q = self.inner(pts).Q if self.dome else None
        if Q is None:
            A, w, ksi, beta = self._family(pts)
            add_power_fibers(pts.F, pts.J, A, w, _NO_AXES, ksi, beta, self.iso, s, wanted(c))
            return
        N, w = _dome()  # directions are the same everywhere, their lengths in the ellipsoids are not
        with np.errstate(divide="ignore"):
            ksi, beta = (self.vector(name, pts) ** -2.0 for name in ("ksi", "beta"))
        add_power_fibers(pts.F, pts.J, N[None], w, np.ascontiguousarray(Q), ksi, beta, self.iso, s, wanted(c))

    def fibers_energy(self, pts: Points) -> Floats:
        A, w, ksi, beta = self._family(pts)
        In = np.empty((pts.n, A.shape[1]))
        squared_stretch(pts.F, pts.J, A, self.iso, In)
        return (w * ksi * np.maximum(In - 1.0, 0.0) ** beta).sum(1)


@variable_record
class EllipsoidalFibers(_Ellipsoidal):
    """Fibers alone."""

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self.fibers(pts, s, c)

    def energy(self, pts: Points) -> Floats:
        return self.fibers_energy(pts)


@variable_record
class EllipsoidalFibersOld(EllipsoidalFibers):
    """Fibers alone, summed over a geodesic dome."""

    dome = True


@variable_record
class EllipsoidalNeoHookean(_Ellipsoidal):
    """Fibers in a neo-Hookean matrix."""

    E: Number = 0.0
    v: Number = 0.0
    parameters = ("E", "v", "beta", "ksi")

    def __post_init__(self) -> None:
        super().__post_init__()
        self._matrix = NeoHookean(self.E, self.v)

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._matrix.stress(pts, s, c)
        self.fibers(pts, s, c)

    def energy(self, pts: Points) -> Floats:
        return self._matrix.energy(pts) + self.fibers_energy(pts)


@variable_record
class EllipsoidalNeoHookeanOld(EllipsoidalNeoHookean):
    """Fibers over a geodesic dome in a neo-Hookean matrix."""

    dome = True


@variable_record
class EllipsoidalFibersUncoupled(_Ellipsoidal, Uncoupled):
    """Fibers of a nearly incompressible solid."""

    iso = True

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self.fibers(pts, s, c)

    def dev_energy(self, pts: Points) -> Floats:
        return self.fibers_energy(pts)

    stress = Uncoupled.stress
    energy = Uncoupled.energy


@variable_record
class EllipsoidalMooneyRivlin(EllipsoidalFibersUncoupled):
    """Fibers in a Mooney-Rivlin matrix."""

    c1: Number = 0.0
    c2: Number = 0.0
    parameters = ("c1", "c2", "beta", "ksi")
    matrix_type = MooneyRivlin

    def __post_init__(self) -> None:
        super().__post_init__()
        self._matrix = self.matrix_type(self.c1, self.c2)

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._matrix.dev(pts, s, c)
        self.fibers(pts, s, c)

    def dev_energy(self, pts: Points) -> Floats:
        return self._matrix.dev_energy(pts) + self.fibers_energy(pts)


@variable_record
class EllipsoidalVerondaWestmann(EllipsoidalMooneyRivlin):
    """Fibers in a Veronda-Westmann matrix."""

    matrix_type = VerondaWestmann  # type: ignore[assignment]


register(EllipsoidalFibers, "ellipsoidal fiber distribution")
register(EllipsoidalFibersOld, "ellipsoidal fiber distribution (old)")
register(EllipsoidalNeoHookean, "EFD neo-Hookean (new)")
register(EllipsoidalNeoHookeanOld, "EFD neo-Hookean")
register(EllipsoidalFibersUncoupled, "EFD uncoupled")
register(EllipsoidalMooneyRivlin, "EFD Mooney-Rivlin")
register(EllipsoidalVerondaWestmann, "EFD Veronda-Westmann")
