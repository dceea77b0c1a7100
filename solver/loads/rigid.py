"""Forces and moments on rigid bodies. FEBio user manual, "Rigid loads"."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..action import Action
from ..record import variable_record
from ..rigid import rotation
from ..values import as_value
from . import register
from .base import Floats, Ints, Matrices, Number, Vector, as_vector, vector

if TYPE_CHECKING:
    from ..state import State

ORIGIN = np.zeros((1, 3))


def _numbers(v: Vector, t: float) -> Floats:
    return vector(as_vector(v), t, ORIGIN, np.zeros(1, int))[0]


@variable_record
class RigidLoad(Action):
    """``body``: index; ``row``: its first row. The force is row 0's, the moment row 1's."""

    body: int
    row: int

    def _turn(self, state: State) -> Floats:
        return rotation.matrix(state.extra["q"][self.body])

    def _mean(self, state: State, alpha: float) -> Floats:
        """The rotation between the last step (alpha 0) and the present (1)."""
        Q = self._turn(state)
        return Q if alpha == 1.0 else alpha * Q + (1 - alpha) * rotation.matrix(state.extra["q_old"][self.body])


@variable_record
class RigidForce(RigidLoad):
    """A force along an axis, which turns with the body where ``follow``."""

    axis: int = 0
    value: Number = 0.0
    follow: bool = False

    def _force(self, state: State) -> Floats:
        f = np.zeros(3)
        f[self.axis] = float(as_value(self.value)(state.time, ORIGIN)[0])
        return self._turn(state) @ f if self.follow else f

    def residual(self, state: State, R: Floats) -> None:
        state.layout.u(R)[self.row] += self._force(state)


@variable_record
class RigidMoment(RigidLoad):
    """A moment about an axis."""

    axis: int = 0
    value: Number = 0.0

    def residual(self, state: State, R: Floats) -> None:
        state.layout.u(R)[self.row + 1, self.axis] += float(as_value(self.value)(state.time, ORIGIN)[0])


@variable_record
class RigidFollowerForce(RigidLoad):
    """A force at a point Z from the centre, both turning with the body: f = Q f0, m = Q Z x f."""

    arm: Floats = field(default_factory=lambda: np.zeros(3))
    given: Vector = (0.0, 0.0, 0.0)

    @property
    def symmetric(self) -> bool:
        return False

    def residual(self, state: State, R: Floats) -> None:
        Q = self._mean(state, self.alpha)
        f, z = Q @ _numbers(self.given, state.time), Q @ self.arm
        Ru = state.layout.u(R)
        Ru[self.row] += f
        Ru[self.row + 1] += np.cross(z, f)

    def cliques(self) -> list[Ints]:
        return [np.array([[self.row, self.row + 1]])]

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        a, Q, mean = self.alpha, self._turn(state), self._mean(state, self.alpha)
        given, K = _numbers(self.given, state.time), np.zeros((1, 6, 6))
        f, z = Q @ given, Q @ self.arm
        K[0, :3, 3:] = a * rotation.skew(f)
        fm, zm = rotation.skew(mean @ given), rotation.skew(mean @ self.arm)
        K[0, 3:, 3:] = a * (zm @ rotation.skew(f) - fm @ rotation.skew(z))
        return [(K, np.array([[self.row] * 3 + [self.row + 1] * 3]), np.tile(state.layout.displacement, 2))]


@variable_record
class RigidFollowerMoment(RigidLoad):
    """A moment that turns with the body."""

    given: Vector = (0.0, 0.0, 0.0)

    @property
    def symmetric(self) -> bool:
        return False

    def residual(self, state: State, R: Floats) -> None:
        state.layout.u(R)[self.row + 1] += self._mean(state, self.alpha) @ _numbers(self.given, state.time)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        K = self.alpha * rotation.skew(self._turn(state) @ _numbers(self.given, state.time))[None]
        return [(K, np.array([[self.row + 1] * 3]), state.layout.displacement)]


@variable_record
class CableEnd(RigidLoad):
    """The force at the end of a cable, of fixed direction, with the moment it has in the reference (as in FEBio)."""

    arm: Floats
    direction: Floats
    value: Number = 0.0

    def residual(self, state: State, R: Floats) -> None:
        f = self.direction * float(as_value(self.value)(state.time, ORIGIN)[0])
        Ru = state.layout.u(R)
        Ru[self.row] += f
        Ru[self.row + 1] += np.cross(self.arm, f)


register(RigidForce, "rigid_force")
register(RigidMoment, "rigid_moment")
register(RigidFollowerForce, "rigid_follower_force")
register(RigidFollowerMoment, "rigid_follower_moment")
register(CableEnd, "rigid_cable")
