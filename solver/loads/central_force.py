"""Body forces towards an axis or a point, or away from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..values import as_value
from . import register
from .base import Floats, Number, Vector, vector
from .body import BodyLoad, Group

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class _Central(BodyLoad):
    """a = -|r|^p S r, r = P (x - c): P and S constant."""

    p: Number = 0.0
    c: Vector = (0.0, 0.0, 0.0)
    moves: ClassVar[bool] = True

    def _number(self, v: Number, t: float) -> float:
        return float(as_value(v)(t, np.zeros((1, 3)))[0])

    def _vector(self, v: Vector, t: float) -> Floats:
        return np.asarray(vector(v, t, np.zeros((1, 3)), np.zeros(1, np.int64))[0])

    def matrices(self, t: float) -> tuple[Floats, Floats]:
        """P and S (3, 3)."""
        raise NotImplementedError

    def _arms(self, state: State, group: Group) -> tuple[Floats, Floats, Floats, float]:
        """r (n, 3), P, S and p."""
        P, S = self.matrices(state.time)
        r = (self.positions(state, group) - self._vector(self.c, state.time)) @ P.T
        return r, P, S, self._number(self.p, state.time)

    def acceleration(self, state: State, group: Group) -> Floats:
        r, _, S, p = self._arms(state, group)
        return np.asarray(-(np.linalg.norm(r, axis=1, keepdims=True) ** p) * (r @ S.T))

    def gradient(self, state: State, group: Group, rate: float) -> Floats:
        """-|r|^p S (I + p r r^T / |r|^2) P."""
        r, P, S, p = self._arms(state, group)
        R = np.linalg.norm(r, axis=1)[:, None, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            grown = np.where(R > 0.0, p * r[:, :, None] * r[:, None, :] / R**2, 0.0) if p else 0.0
        return np.asarray(-(R**p) * (S @ (np.eye(3) + grown) @ P))


@dataclass(eq=False)
class AxialForce(_Central):
    """f = scale |r|^p r, r from the ``axis`` through c. FEBio User Manual, "Axial force"."""

    scale: Number = 1.0
    axis: Vector = (0.0, 0.0, 1.0)

    def matrices(self, t: float) -> tuple[Floats, Floats]:
        n = self._vector(self.axis, t)
        return np.eye(3) - np.outer(n, n) / (n @ n), self._number(self.scale, t) * np.eye(3)


@dataclass(eq=False)
class RadialForce(_Central):
    """f = |r|^p diag(sx, sy, sz) r, r from c. FEBio User Manual, "Radial force"."""

    sx: Number = 1.0
    sy: Number = 1.0
    sz: Number = 1.0
    symmetric: ClassVar[bool] = False  # the factors differ

    def matrices(self, t: float) -> tuple[Floats, Floats]:
        return np.eye(3), np.diag([self._number(v, t) for v in (self.sx, self.sy, self.sz)])


register(AxialForce, "axial force")
register(RadialForce, "radial force")
