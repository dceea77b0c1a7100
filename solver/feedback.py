"""Load controllers by feedback: a number that follows what has been solved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .action import Action

if TYPE_CHECKING:
    from .group import Group
    from .state import State


@dataclass(eq=False)
class Pid(Action):
    """Kp e + Ki int e dt + Kd de/dt, e = target - measure, renewed as a step begins, from the last converged state.

    ``measure`` takes a number from a state; ``name`` is that of the controller. FEBio user manual, "PID controller".
    """

    name: str
    measure: Callable[[State], float]
    target: float = 0.0
    Kp: float = 0.0
    Ki: float = 0.0
    Kd: float = 0.0
    value: float = field(init=False, default=0.0)
    measured: float = field(init=False, default=0.0)
    _last: tuple[float, float, float] = field(init=False, default=(0.0, 0.0, 0.0))  # time, error, integral

    @property
    def error(self) -> float:
        return self._last[1]

    def __call__(self, t: float) -> float:
        return self.value

    def begin(self, state: State, groups: list[Group]) -> None:
        self.measured = self.measure(state)
        e = self.target - self.measured
        self.value, self._last = self.Kp * e, (state.time, e, 0.0)

    def begin_step(self, state: State) -> None:
        self.measured = self.measure(state)
        time, last, total = self._last
        e, dt = self.target - self.measured, state.time - time
        total += e * dt
        rate = (e - last) / dt if dt > 0 else 0.0
        self.value, self._last = self.Kp * e + self.Ki * total + self.Kd * rate, (state.time, e, total)

    def residual(self, state: State, R: NDArray[np.float64]) -> None:
        """It acts through the loads and conditions that name it."""

    def snapshot(self) -> Any:
        return self.value, self.measured, self._last

    def restore(self, saved: Any) -> None:
        self.value, self.measured, self._last = saved
