"""Active stress along the first material axis, scaled by functions of stretch and of its rate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..points import Points
from .base import Floats, Number, Property
from .fiber import Fiber, FiberLaw, UncoupledFiber
from .registry import register

_NONE = np.empty((0, 0))
_CURVES = {"stl": Property("curve", optional=True), "stv": Property("curve", optional=True)}


def _value(curve: Any, x: Floats) -> Floats:
    return np.ones_like(x) if curve is None else np.asarray(np.broadcast_to(curve(x), x.shape), dtype=float)


def _slope(curve: Any, x: Floats) -> Floats:
    if curve is None:
        return np.zeros_like(x)
    h = 1e-6 * (1.0 + np.abs(x))
    return (_value(curve, x + h) - _value(curve, x - h)) / (2.0 * h)


@dataclass(eq=False)
class _Active(FiberLaw):
    """Tension smax activation stl(l) stv(0): FEBio 4.11 evaluates the rate's function at rest."""

    consistent = False

    def tension(self, pts: Points, In: Floats, sn: Floats, cn: Floats) -> Floats:
        smax, activation = self.par(pts).T[:, :, None]  # type: ignore[attr-defined]
        stl, stv = self.stl, self.stv  # type: ignore[attr-defined]
        l, still = np.sqrt(In), np.zeros_like(In)
        sn[:] = smax * activation * _value(stl, l) * _value(stv, still)
        slope = _slope(stl, l) * _value(stv, still) + _value(stl, l) * _slope(stv, still)
        cn[:] = l * smax * activation * slope - 2.0 * sn
        return _NONE


@dataclass(eq=False)
class ActiveFiberStress(_Active, Fiber):
    """sigma = smax activation stl(l) stv / J n dyad n, n = F e1 / l."""

    smax: Number = 0.0
    activation: Number = 0.0
    stl: Any = None
    stv: Any = None
    parameters = ("smax", "activation")
    properties = _CURVES


@dataclass(eq=False)
class ActiveFiberStressUncoupled(_Active, UncoupledFiber):
    """The deviator of it, by the distortional stretch."""

    smax: Number = 0.0
    activation: Number = 0.0
    stl: Any = None
    stv: Any = None
    parameters = ("smax", "activation")
    properties = _CURVES


register(ActiveFiberStress, "active fiber stress")
register(ActiveFiberStressUncoupled, "uncoupled active fiber stress")
