"""Damping in proportion to mass and velocity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..values import as_value
from . import register
from .base import Floats, Number
from .body import BodyLoad, Group

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class MassDamping(BodyLoad):
    """a = -C v. FEBio User Manual, "Mass Damping"."""

    C: Number = 0.0
    moves = True

    def __post_init__(self) -> None:
        self.C = as_value(self.C)

    def _number(self, t: float) -> float:
        return float(self.C(t, np.zeros((1, 3)))[0])  # type: ignore[operator]

    def acceleration(self, state: State, group: Group) -> Floats:
        return -self._number(state.time) * self.velocities(state, group)

    def gradient(self, state: State, group: Group, rate: float) -> Floats:
        return -self._number(state.time) * rate * np.eye(3)[None]


register(MassDamping, "mass damping")
