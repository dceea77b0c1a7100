"""Fibers that are recruited by a distribution of slack lengths, integrated along the path of stretch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..points import Points
from .base import Floats, Number, Property
from .fiber import Fiber, FiberLaw, UncoupledFiber
from .registry import register

_STEP = 1e-2
Floats4 = tuple[Floats, Floats, Floats, Floats]


@dataclass(eq=False)
class _Recruited(FiberLaw):
    """dW/dIn = E/4 s (In - 1), ds/dIn = cdf(In - 1), by the trapezoidal rule in steps of at most 0.01.

    History: In - 1, W, s, cdf. For one direction only, as in FEBio.
    """

    consistent = False

    def _advance(self, pts: Points, x: Floats) -> Floats4:
        """(In - 1, energy sum, s, cdf) at strain x (n,)."""
        at = self.offset  # type: ignore[attr-defined]
        old = np.zeros((pts.n, 4)) if pts.old is None else pts.old[:, at : at + 4]
        x0, W, s, d = (old[:, k].copy() for k in range(4))
        on = x >= np.finfo(float).eps
        steps = np.where(on, np.maximum(np.ceil((x - x0) / _STEP - 1e-12), 1), 0).astype(int)
        for k in range(int(steps.max(initial=0))):
            live = k < steps
            x1 = np.where(k + 1 < steps, x0 + _STEP, x)
            d1 = np.maximum(np.broadcast_to(self.cdf_.cdf(pts, x1), (pts.n,)), 0.0)  # type: ignore[attr-defined]
            dx = x1 - x0
            W = np.where(live, W + s * dx + 0.25 * dx * dx * (d1 + d), W)
            s = np.where(live, s + 0.5 * dx * (d1 + d), s)
            x0, d = np.where(live, x1, x0), np.where(live, d1, d)
        d = np.where(x <= 0, 0.0, d)
        if pts.new is not None:
            pts.new[:, at : at + 4] = np.stack((x, W, s, d), axis=1)
        return x, W, s, d

    def _modulus(self, pts: Points) -> Floats:
        return 0.25 * self.par(pts)[:, 0]  # type: ignore[attr-defined, no-any-return]

    def tension(self, pts: Points, In: Floats, sn: Floats, cn: Floats) -> Floats:
        if In.shape[1] != 1:
            raise NotImplementedError("fiber-CDF keeps the history of one direction only")
        x, _, s, d = self._advance(pts, In[:, 0] - 1.0)
        k, on = self._modulus(pts), x >= np.finfo(float).eps
        sn[:, 0] = np.where(on, 2.0 * In[:, 0] * k * s * x, 0.0)
        cn[:, 0] = np.where(on, 4.0 * In[:, 0] ** 2 * k * (d * x + s), 0.0)
        return np.empty((0, 0))

    def fiber_energy(self, pts: Points, In: Floats) -> Floats:
        x, W, _, _ = self._advance(pts, In[:, 0] - 1.0)
        return np.where(x >= 0, self._modulus(pts) * W, 0.0)[:, None]


@dataclass(eq=False)
class FiberCDF(_Recruited, Fiber):
    """Recruited fibers."""

    E: Number = 0.0
    cdf_: Any = None
    parameters = ("E",)
    properties = {**Fiber.properties, "cdf_": Property("cdf")}
    history = 4


@dataclass(eq=False)
class FiberCDFUncoupled(_Recruited, UncoupledFiber):
    """Recruited fibers of a nearly incompressible solid."""

    E: Number = 0.0
    cdf_: Any = None
    parameters = ("E",)
    properties = {**UncoupledFiber.properties, "cdf_": Property("cdf")}
    history = 4


for _table in ("solid", "fiber"):
    register(FiberCDF, "fiber-CDF", _table)
    register(FiberCDFUncoupled, "fiber-CDF-uncoupled", _table)
