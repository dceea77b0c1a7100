"""Fibers of one law in all directions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..points import Points
from .base import Floats, Number, Solid
from .bound import Bound
from .ellipsoidal_fibers import _octants
from .fiber_exp_pow import _ExpPow
from .registry import register


@dataclass(eq=False)
class SphericalFibers(_ExpPow, Solid):
    """W = sum_j w_j ksi (exp[alpha (In_j - 1)^beta] - 1) / alpha over directions in tension."""

    alpha: Number = 0.0
    beta: Number = 2.0
    ksi: Number = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("alpha", "beta", "ksi")
    _eps = float(np.finfo(float).tiny)  # a fiber at rest does not count

    def _five(self, pts: Points) -> Floats:
        alpha, beta, ksi = self.par(pts).T
        return np.column_stack((alpha, beta, beta * ksi, 0.0 * ksi, 1.0 + 0.0 * ksi))

    def _family(self, pts: Points) -> tuple[Floats, Floats]:
        """Directions (1|n, 180, 3) and weights (1, 180)."""
        (N, w), Q = _octants(), self.inner(pts).Q
        return np.ascontiguousarray(N[None] if Q is None else N[None] @ np.swapaxes(Q, 1, 2)), w[None]

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self.add(pts, *self._family(pts), s, c)

    def energy(self, pts: Points) -> Floats:
        return self.sum_energy(pts, *self._family(pts))


@dataclass(eq=False)
class SphericalFibersBound(Bound, SphericalFibers):
    """ksi = ksi0 (rho / rho0)^gamma. FEBio User Manual, "spherical fiber distribution sbm"."""

    ksi0: Number = 0.0
    rho0: Number = 1.0
    gamma: Number = 0.0
    sbm: int | str = 0
    parameters = ("alpha", "beta", "ksi0", "rho0", "gamma")

    def _five(self, pts: Points) -> Floats:
        alpha, beta, ksi0 = self.par(pts)[:, :3].T
        ksi = ksi0 * self.factor(pts)
        return np.stack(np.broadcast_arrays(alpha, beta, beta * ksi, 0.0, 1.0), axis=1)


register(SphericalFibers, "spherical fiber distribution")
register(SphericalFibersBound, "spherical fiber distribution sbm")
