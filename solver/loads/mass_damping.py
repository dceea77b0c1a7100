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

    def _rate(self, state: State, group: Group) -> Floats:
        """C at the points of a group (1|n,)."""
        pts = group.points()
        return np.asarray(self.C(state.time, pts.X, pts.e))  # type: ignore[operator]

    def acceleration(self, state: State, group: Group) -> Floats:
        return -self._rate(state, group)[:, None] * self.velocities(state, group)

    def gradient(self, state: State, group: Group, rate: float) -> Floats:
        return -rate * self._rate(state, group)[:, None, None] * np.eye(3)


register(MassDamping, "mass damping")
