"""Inertia seen from a frame that turns and accelerates."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from ..rigid import rotation
from ..values import as_value
from . import register
from .base import Floats, Number
from .body import BodyLoad, Group

if TYPE_CHECKING:
    from ..state import State

ORIGIN = np.zeros((1, 3))


class _Frame(NamedTuple):
    """At one time: orientation, angular velocity and its rate (of the fixed frame, or of the moving one), and the
    origin's acceleration."""

    time: float
    q: Floats
    w: Floats
    dw: Floats
    a: Floats


@dataclass(eq=False)
class MovingFrame(BodyLoad):
    """a = -(A + W' x r + W x (W x r) + 2 W x v), in the moving frame. FEBio User Manual, "Moving Frame".

    The angular velocity w is given in the fixed frame, or in the moving one where ``moving``; A is that of the origin,
    given in the fixed frame. The frame turns by backward Euler, q' = w q / 2.
    """

    wx: Number = 0.0
    wy: Number = 0.0
    wz: Number = 0.0
    ax: Number = 0.0
    ay: Number = 0.0
    az: Number = 0.0
    moving: bool = False
    moves: ClassVar[bool] = True
    _before: _Frame | None = field(default=None, init=False, repr=False)
    _now: _Frame | None = field(default=None, init=False, repr=False)

    @property
    def symmetric(self) -> bool:
        return False

    def begin(self, state: State, groups: list[Group]) -> None:
        self._before = self._now = None

    def begin_step(self, state: State) -> None:
        """Turn the frame over the step, from where it was as the step began."""
        start, zero = state.time - state.dt, np.zeros(3)
        if self._now is None or start <= 0.0:
            self._before = _Frame(start, np.array(rotation.IDENTITY), zero, zero, self._pushed(max(start, 0.0)))
        else:
            self._before = self._now
        before, dt = self._before, state.dt
        assert before is not None
        w = self._numbers(state.time, self.wx, self.wy, self.wz)
        now = _Frame(state.time, self._turned(before.q, w, dt), w, (w - before.w) / dt, self._pushed(state.time))
        self._now = now
        # at the instant at which forces are taken
        W, dW, A = (self._between(getattr(now, name), getattr(before, name)) for name in ("w", "dw", "a"))
        turn = rotation.matrix(self._turned(before.q, W, self.alpha * dt)).T
        if not self.moving:
            W, dW = turn @ W, turn @ dW
        self._W, self._dW, self._A = rotation.skew(W), rotation.skew(dW), turn @ A

    def snapshot(self) -> Any:
        return self._before, self._now

    def restore(self, saved: Any) -> None:
        self._before, self._now = (None if f is None else _Frame(*f) for f in saved)

    def _turned(self, q: Floats, w: Floats, dt: float) -> Floats:
        """The orientation q turned with the angular velocity w for dt."""
        spin = np.append(w, 0.0)
        return rotation.unit(q + 0.5 * dt * (rotation.product(q, spin) if self.moving else rotation.product(spin, q)))

    def _pushed(self, t: float) -> Floats:
        """The origin's acceleration."""
        return self._numbers(t, self.ax, self.ay, self.az)

    @staticmethod
    def _numbers(t: float, *values: Number) -> Floats:
        return np.array([float(as_value(v)(t, ORIGIN)[0]) for v in values])

    def acceleration(self, state: State, group: Group) -> Floats:
        if self._now is None:  # forces at the start of a dynamic analysis: the frame is at rest
            return np.zeros((1, 3))
        r, v = self.positions(state, group), self.velocities(state, group)
        return np.asarray(-(self._A + r @ (self._dW + self._W @ self._W).T + 2.0 * v @ self._W.T))

    def gradient(self, state: State, group: Group, rate: float) -> Floats:
        return np.asarray(-(self._dW + self._W @ self._W + 2.0 * rate * self._W))[None]


register(MovingFrame, "moving frame")
