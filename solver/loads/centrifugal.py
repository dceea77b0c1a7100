"""Centrifugal body force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..values import as_value
from . import register
from .base import Floats, Number, Vector, vector
from .body import BodyLoad, Group

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class Centrifugal(BodyLoad):
    """a = w^2 (I - n n) (x - c). FEBio User Manual, "Centrifugal Body Force"."""

    angular_speed: Number = 0.0
    rotation_axis: Vector = (0.0, 0.0, 1.0)
    rotation_center: Vector = (0.0, 0.0, 0.0)
    moves = True

    def __post_init__(self) -> None:
        self.angular_speed = as_value(self.angular_speed)

    @staticmethod
    def _at(v: Vector, t: float) -> Floats:
        return np.asarray(vector(v, t, np.zeros((1, 3)), np.zeros(1, np.int64))[0])

    def _matrix(self, t: float) -> Floats:
        n = self._at(self.rotation_axis, t)
        w = float(self.angular_speed(t, np.zeros((1, 3)))[0])  # type: ignore[operator]
        return np.asarray(w * w * (np.eye(3) - np.outer(n, n)))

    def acceleration(self, state: State, group: Group) -> Floats:
        arm = self.positions(state, group) - self._at(self.rotation_center, state.time)
        return np.asarray(arm @ self._matrix(state.time))

    def gradient(self, state: State, group: Group, rate: float) -> Floats:
        return self._matrix(state.time)[None]


register(Centrifugal, "centrifugal")
