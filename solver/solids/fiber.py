"""Fibers: solids that bear load along reference directions only.

A fiber record is a solid where it has a direction (``fiber``), and a law of directions where a
continuous distribution hands it many.
"""

from __future__ import annotations

from dataclasses import field
from typing import Any

import numpy as np

from ..kernels.fibers import add_fibers, squared_stretch
from ..points import Points
from ..record import variable_record
from .base import Floats, Property, Solid, unwritten, wanted
from .uncoupled import Uncoupled

_BATCH = 1 << 17  # stretches held at a time
_NONE = np.empty((0, 0))


def directions(fiber: Any, pts: Points) -> Floats:
    """Unit reference directions (1|n, 3): the local vectors of ``fiber`` turned by ``pts.Q``."""
    if fiber is None or getattr(fiber, "steady", False):
        return pts.once((fiber, pts.Q), lambda: _directions(fiber, pts))
    return _directions(fiber, pts)


def _directions(fiber: Any, pts: Points) -> Floats:
    if fiber is None:
        a = np.array([[1.0, 0.0, 0.0]])
    else:
        a = np.atleast_2d(np.asarray(fiber(pts), dtype=float))
        a = a / np.linalg.norm(a, axis=1, keepdims=True)
    if pts.Q is not None:
        a = np.einsum("nij,nj->ni", np.broadcast_to(pts.Q, (max(len(a), len(pts.Q)), 3, 3)), a)
    return np.ascontiguousarray(a)


def prestretched(a: Floats, pts: Points) -> Floats:
    """Directions (1|n, m, 3) turned by ``pts.extra["prestretch"]`` (n, 3, 3), the stretch at which a
    generation of bonds was born, where there is one."""
    U = pts.extra.get("prestretch")
    if U is not None:
        a = a @ U
        a = a / np.linalg.norm(a, axis=-1, keepdims=True)
    return np.ascontiguousarray(a)


def part(pts: Points, at: slice) -> Points:
    """The points of a slice."""

    def cut(a: Floats | None) -> Floats | None:
        return a if a is None or len(a) == 1 else a[at]

    return pts.but(
        F=pts.F[at],
        J=pts.J[at],
        X=pts.X[at],
        e=pts.e[at],
        known={},
        Q=cut(pts.Q),
        old=None if pts.old is None else pts.old[at],
        new=None if pts.new is None else pts.new[at],
        extra={k: v[at] if isinstance(v, np.ndarray) and len(v) == pts.n else v for k, v in pts.extra.items()},
    )


@variable_record
class FiberLaw:
    """The part coupled and uncoupled fibers share. Subclasses give the tension of a fiber."""

    iso = False

    def tension(self, pts: Points, In: Floats, sn: Floats, cn: Floats) -> Floats:
        """Fill ``sn`` = 2 In dW/dIn and ``cn`` = 4 In^2 d2W/dIn2, all (n, m); return the shear modulus of each
        fiber, or an array (0, 0)."""
        raise NotImplementedError

    def shears(self, pts: Points) -> bool:
        """Has it a shear term?"""
        return False

    def fiber_energy(self, pts: Points, In: Floats) -> Floats:
        """W(In) (n, m) per reference volume."""
        raise NotImplementedError(f"{type(self).__name__} gives no strain energy")

    def shear_energy(self, pts: Points, A: Floats, In: Floats) -> Floats | float:
        """Energy (n, m) of the shear term."""
        return 0.0

    def add(self, pts: Points, A: Floats, w: Floats, s: Floats, c: Floats | None) -> None:
        """Add the stress of fibers along ``A`` (1|n, m, 3) with weights ``w`` (1|n, m)."""
        step = max(1, _BATCH // A.shape[1])
        for a in range(0, pts.n, step):
            at = slice(a, min(a + step, pts.n))
            here = part(pts, at) if step < pts.n else pts
            Ah, wh = (A if len(A) == 1 else A[at]), (w if len(w) == 1 else w[at])
            In = np.empty((here.n, A.shape[1]))
            squared_stretch(here.F, here.J, Ah, self.iso, In)
            sn, cn = np.empty_like(In), np.empty_like(In)
            g = self.tension(here, In, sn, cn)
            add_fibers(
                here.F, here.J, Ah, wh, In, sn, cn, g, self.iso, s[at], wanted(c if c is None else c[at])
            )

    def sum_energy(self, pts: Points, A: Floats, w: Floats) -> Floats:
        """sum_j w_j W(In_j) (n,)."""
        out = np.zeros(pts.n)
        step = max(1, _BATCH // A.shape[1])
        for a in range(0, pts.n, step):
            at = slice(a, min(a + step, pts.n))
            here = part(pts, at) if step < pts.n else pts
            Ah, wh = (A if len(A) == 1 else A[at]), (w if len(w) == 1 else w[at])
            In = np.empty((here.n, A.shape[1]))
            squared_stretch(here.F, here.J, Ah, self.iso, In)
            out[at] = (wh * (self.fiber_energy(here, In) + self.shear_energy(here, Ah, In))).sum(1)
        return out


_ONE = np.ones((1, 1))


@variable_record
class Fiber(FiberLaw, Solid):
    """A family of fibers along ``fiber``."""

    fiber: Any = field(default=None, kw_only=True)  # local direction: pts -> (1|n, 3)
    properties = {"fiber": Property("direction", default="vector")}
    iso = False

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self.add(pts, directions(self.fiber, self.inner(pts))[:, None], _ONE, s, c)

    def energy(self, pts: Points) -> Floats:
        return self.sum_energy(unwritten(pts), directions(self.fiber, self.inner(pts))[:, None], _ONE)


@variable_record
class UncoupledFiber(FiberLaw, Uncoupled):
    """A family of fibers along ``fiber`` in a nearly incompressible solid."""

    fiber: Any = field(default=None, kw_only=True)
    properties = {"fiber": Property("direction", optional=True, default="vector")}
    iso = True

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self.add(pts, directions(self.fiber, self.inner(pts))[:, None], _ONE, s, c)

    def dev_energy(self, pts: Points) -> Floats:
        return self.sum_energy(unwritten(pts), directions(self.fiber, self.inner(pts))[:, None], _ONE)
