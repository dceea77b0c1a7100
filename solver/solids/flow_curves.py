"""Plastic flow curves as families of bonds: yield measure and mass fraction of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from ..points import Points
from ..values import as_value
from .base import Floats, Number, Property
from .registry import register


@dataclass(eq=False)
class FlowCurve:
    """``families(pts)``: yield measures (1|n, nf) and mass fractions (1|n, nf + 1), the last of which never yields.

    Zimmerman, Jiang & Ateshian, J. Biomech. Eng. 143 (2021) 041002.
    """

    parameters: ClassVar[tuple[str, ...]] = ()
    options: ClassVar[tuple[str, ...]] = ()
    properties: ClassVar[dict[str, Property]] = {}

    @property
    def size(self) -> int:
        raise NotImplementedError

    def families(self, pts: Points) -> tuple[Floats, Floats]:
        raise NotImplementedError


@dataclass(eq=False)
class Geometric(FlowCurve):
    """nf families from Y0 to Ymax whose fractions and steps of stress follow a geometric series of ratio r."""

    Y0: Number = 0.0
    Ymax: Number = 0.0
    w0: Number = 1.0
    we: Number = 0.0
    nf: int = 1
    r: Number = 0.9
    parameters = ("Y0", "Ymax", "w0", "we", "r")
    options = ("nf",)
    _found: Any = field(default=None, init=False, repr=False)  # the families, where they are the same everywhere

    @property
    def size(self) -> int:
        return int(self.nf)

    def families(self, pts: Points) -> tuple[Floats, Floats]:
        if self._found is not None:
            return self._found  # type: ignore[no-any-return]
        values = [as_value(getattr(self, p)) for p in self.parameters]
        found = self._made(*(v(pts.t, pts.X, pts.e) for v in values))
        if all(v.constant for v in values):
            self._found = found
        return found

    def _made(self, *values: Floats) -> tuple[Floats, Floats]:
        Y0, Ymax, w0, we, r = np.broadcast_arrays(*values)
        n = self.size
        Ky, w = np.zeros((len(Y0), n)), np.zeros((len(Y0), n + 1))
        Ky[:, 0], w[:, 0], w[:, n] = Y0, w0, we
        if n > 1:
            power = np.arange(n - 1)
            series = r[:, None] ** power
            share = series / series.sum(1, keepdims=True)
            w[:, 1:n] = share * (1.0 - we - w0)[:, None]
            step = share * (Ymax - Y0)[:, None]
            left = 1.0 - np.cumsum(w[:, : n - 1], axis=1)
            Ky[:, 1:] = Y0[:, None] + np.cumsum(step / left, axis=1)
        return Ky, w


def _of_points(strain: Floats, stress: Floats) -> tuple[Floats, Floats]:
    """Families whose sum is piecewise linear through (strain, stress), the first point being the yield point."""
    n = len(strain)
    Ky = stress[0] / strain[0] * strain
    w = np.zeros(n + 1)
    slope = np.diff(stress) / np.diff(Ky)
    total = np.append(1.0 - slope, 1.0)
    w[:n] = np.diff(total, prepend=0.0)
    return Ky[None], w[None]


@dataclass(eq=False)
class UserCurve(FlowCurve):
    """Families through the points (strain, stress) of ``plastic_response.points``."""

    plastic_response: Any = None
    properties = {"plastic_response": Property("curve")}

    @property
    def size(self) -> int:
        return len(self.plastic_response.points)

    def families(self, pts: Points) -> tuple[Floats, Floats]:
        p = np.asarray(self.plastic_response.points, dtype=float)
        return _of_points(p[:, 0], p[:, 1])


@dataclass(eq=False)
class MathCurve(FlowCurve):
    """Families through nf points of a formula of the strain, at equal steps of stress from e0 to emax."""

    nf: int = 1
    e0: Number = 0.0
    emax: Number = 1.0
    plastic_response: Callable[[float], float] | None = None
    parameters = ("e0", "emax")
    options = ("nf",)
    properties = {"plastic_response": Property("formula")}
    _found: Any = field(default=None, init=False, repr=False)  # pairs of strains and the families between them
    _constant: Any = field(default=None, init=False, repr=False)  # the families, where they are the same everywhere

    @property
    def size(self) -> int:
        return int(self.nf)

    def families(self, pts: Points) -> tuple[Floats, Floats]:
        values = as_value(self.e0), as_value(self.emax)
        if self._constant is not None:
            return self._constant  # type: ignore[no-any-return]
        e0, emax = np.broadcast_arrays(*(v(pts.t, pts.X, pts.e) for v in values))
        ends, which = np.unique(np.stack([e0, emax], axis=1), axis=0, return_inverse=True)
        key = ends.tobytes()
        if self._found is None or self._found[0] != key:
            Ky, w = zip(*(self._between(float(a), float(b)) for a, b in ends))
            self._found = key, np.concatenate(Ky), np.concatenate(w)
        _, strains, fractions = self._found
        which = which.reshape(-1)
        out = strains[which], fractions[which]
        if all(v.constant for v in values):
            self._constant = out
        return out

    def _between(self, a: float, b: float) -> tuple[Floats, Floats]:
        Y: Any = self.plastic_response
        if self.size == 1:
            return np.array([[float(Y(a))]]), np.array([[1.0, 0.0]])
        stress = np.linspace(float(Y(a)), float(Y(b)), self.size)
        inside = [_where(Y, y, a, b) for y in stress[1:-1]]
        return _of_points(np.array([a, *inside, b]), stress)


def _where(Y: Callable[[float], float], y: float, a: float, b: float) -> float:
    """Where Y = y between a and b, by bisection to the last bit."""
    rising = float(Y(a)) < y
    while True:
        e = 0.5 * (a + b)
        if e in (a, b):
            return e
        a, b = (e, b) if (float(Y(e)) < y) == rising else (a, e)


register(Geometric, "PFC paper", "flow_curve")
register(UserCurve, "PFC user", "flow_curve")
register(MathCurve, "PFC math", "flow_curve")
