"""Mooney-Rivlin and Veronda-Westmann solids with fibers of the exp-linear law spread over a plane."""

from __future__ import annotations

from dataclasses import field
from typing import Any

import numpy as np

from ..kernels.fibers import add_fibers, squared_stretch
from ..points import Points
from ..record import variable_record
from . import mooney_rivlin, veronda_westmann
from .axes import turn
from .base import Floats, Number, Property, Solid, wanted
from .fiber import directions
from .fiber_exp_linear import fiber_energy, tension
from .invariants import isochoric_invariants
from .registry import register
from .uncoupled import Uncoupled


def _circle() -> Floats:
    """Twelve directions (12, 3) across the first axis."""
    t = 2.0 * np.pi * np.arange(12) / 12
    return np.stack((0.0 * t, np.cos(t), np.sin(t)), axis=1)


def _ellipse(solid: Solid, name: str, pts: Points) -> Floats:
    """Radii (1|n, 12) of the ellipse whose axes are a parameter."""
    axes = solid.vector(name, pts)[:, None, :]
    return np.asarray(((_circle()[None, :, 1:] / axes) ** 2).sum(2) ** -0.5)


def _shares(solid: Solid, pts: Points) -> Floats:
    """Weights (1|n, 12) that follow the ellipse of ``w``."""
    w = _ellipse(solid, "w", pts)
    return np.ascontiguousarray(w / w.sum(1, keepdims=True))


@variable_record
class _Planar(Uncoupled):
    c1: Number = 0.0
    c2: Number = 0.0
    c3: Number = 0.0
    c4: Number = 0.0
    c5: Number = 0.0
    lam_max: Number = 1.0

    def family(self, pts: Points) -> tuple[Floats, Floats]:
        """Directions (1|n, m, 3) and weights (1|n, m)."""
        raise NotImplementedError

    def active(self, pts: Points) -> Floats | float:
        """Active tension to add to each fiber (1|n, m)."""
        return 0.0

    def matrix(self, pts: Points, s: Floats, c: Floats | None) -> None:
        """Add the matrix of c1 and c2."""
        mooney_rivlin.run(pts.F, pts.J, self.par(pts), s, wanted(c))

    def matrix_energy(self, pts: Points) -> Floats:
        I1, I2 = isochoric_invariants(pts)
        c1, c2 = self.par(pts).T[:2]
        return c1 * (I1 - 3) + c2 * (I2 - 3)

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        par = self.par(pts)
        self.matrix(pts, s, c)
        A, w = self.family(pts)
        In = np.empty((pts.n, A.shape[1]))
        squared_stretch(pts.F, pts.J, A, True, In)
        sn, cn = np.empty_like(In), np.empty_like(In)
        tension(In, np.ascontiguousarray(par[:, 2:6]), sn, cn)
        T = self.active(pts)
        add_fibers(
            pts.F, pts.J, A, w, In, sn + T, cn - 2.0 * T, np.empty((0, 0)), True, s, wanted(c)
        )

    def dev_energy(self, pts: Points) -> Floats:
        A, w = self.family(pts)
        In = np.empty((pts.n, A.shape[1]))
        squared_stretch(pts.F, pts.J, A, True, In)
        return self.matrix_energy(pts) + (w * fiber_energy(In, self.par(pts)[:, 2:6])).sum(1)


@variable_record
class PlanarFibers(_Planar):
    """Twelve directions in the plane across ``fiber``, with an elliptic density of axes ``w``."""

    active_contraction: Number = 0.0
    w: Any = (1.0, 1.0)
    a: Any = (1.0, 1.0)
    fiber: Any = field(default=None, kw_only=True)
    parameters = ("c1", "c2", "c3", "c4", "c5", "lam_max", "active_contraction", "w", "a")
    vectors = {"w": 2, "a": 2}
    properties = {"fiber": Property("direction", default="vector")}

    def family(self, pts: Points) -> tuple[Floats, Floats]:
        r = directions(self.fiber, pts.but(Q=None))
        A = turn(_circle()[None], np.array([1.0, 0.0, 0.0]), r[:, None])
        return np.ascontiguousarray(A), _shares(self, pts)

    def active(self, pts: Points) -> Floats | float:
        return self.par(pts)[:, 6, None] * _ellipse(self, "a", pts)


@variable_record
class PlanarFibersVerondaWestmann(_Planar):
    """Twelve directions in the plane of the second and third material axis, in a Veronda-Westmann matrix."""

    w: Any = (1.0, 1.0)
    parameters = ("c1", "c2", "c3", "c4", "c5", "lam_max", "w")
    vectors = {"w": 2}

    def family(self, pts: Points) -> tuple[Floats, Floats]:
        Q = self.inner(pts).Q
        A = _circle()[None] if Q is None else _circle()[None] @ np.swapaxes(Q, 1, 2)
        return np.ascontiguousarray(A), _shares(self, pts)

    def matrix(self, pts: Points, s: Floats, c: Floats | None) -> None:
        veronda_westmann.run(pts.F, pts.J, self.par(pts), s, wanted(c))

    def matrix_energy(self, pts: Points) -> Floats:
        I1, I2 = isochoric_invariants(pts)
        c1, c2 = self.par(pts).T[:2]
        return c1 * np.expm1(c2 * (I1 - 3.0)) - 0.5 * c1 * c2 * (I2 - 3.0)


@variable_record
class VonMisesFibers(_Planar):
    """A von Mises density about the angle ``tp`` in the plane of the first two local axes, ``gipt`` Gauss points.

    Girard, Downs, Burgoyne & Suh, J. Biomech. Eng. 131 (2009) 051011. vmc = 2 mixes in a uniform density.
    """

    kf: Number = 0.0
    tp: Number = 0.0
    var_n: Number = 1.0
    gipt: int = 10
    vmc: int = 1
    parameters = ("c1", "c2", "c3", "c4", "c5", "lam_max", "kf", "tp", "var_n")
    options = ("gipt", "vmc")

    def family(self, pts: Points) -> tuple[Floats, Floats]:
        from scipy.special import i0, i1

        kf, tp, var_n = self.par(pts)[:, 6:].T[:, :, None]
        x, g = np.polynomial.legendre.leggauss(10)
        parts = int(self.gipt) // 10
        width = np.pi / parts
        t = (np.arange(parts)[:, None] * width + 0.5 * width * (x + 1.0)).ravel() - 0.5 * np.pi
        weight = np.tile(0.5 * width * g, parts)
        density = np.exp(kf * np.cos(2.0 * t)) / (np.pi * i0(kf))
        if self.vmc == 2:
            share = (i1(kf) / i0(kf)) ** var_n
            density = (1.0 - share) / np.pi + share * density
        angle = tp + t
        local = np.stack((np.cos(angle), np.sin(angle), 0.0 * angle), axis=-1)
        Q = self.inner(pts).Q
        A = local if Q is None else local @ np.swapaxes(Q, 1, 2)
        return np.ascontiguousarray(A), np.ascontiguousarray(density * weight)


register(PlanarFibers, "2D trans iso Mooney-Rivlin")
register(PlanarFibersVerondaWestmann, "2D trans iso Veronda-Westmann")
register(VonMisesFibers, "Mooney-Rivlin von Mises Fibers")
