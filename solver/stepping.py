"""Step sizes: fixed, or FEBio's time stepper with must points and retries (user manual, time_stepper)."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, inf, sqrt
from typing import Any

from .problem import AutoStep, Step

HALVINGS = 8  # of a step that goes beyond FEBio's retries
SMALLEST = 1e-12  # step over end time, as for the distance of must points
FAR = 1000.0  # periods of must points that repeat


class FixedSteps:
    """``count`` steps of ``dt``."""

    def __init__(self, step: Step, start: float) -> None:
        self.dt = step.dt
        self.retries = 0
        self.beyond = False  # past what FEBio would do
        self.end = start + (step.dt * step.count if step.duration is None else step.duration)
        if not (step.dt > 0 and start < self.end < inf):
            raise ValueError(f"no time steps of {step.dt:g} lead from time {start:g} to {self.end:g}")
        self.at_must_point = False

    def first(self, t: float) -> None:
        pass

    def accept(self, t: float, iterations: int) -> None:
        """The step to ``t`` converged in so many iterations."""

    def snapshot(self) -> dict[str, Any]:
        """All numbers but the end, which the analysis step gives."""
        return {k: v for k, v in vars(self).items() if isinstance(v, (int, float, tuple)) and k != "end"}

    def restore(self, saved: dict[str, Any]) -> None:
        vars(self).update(saved)

    def go_on(self, t: float, saved: dict[str, Any]) -> None:
        """Go on from ``t`` with the size that other steps had come to."""

    def retry(self) -> bool:
        """Make the step smaller; False where it may not be."""
        return False

    def persist(self) -> bool:
        """FEBio would end here: go on with the present size, halved where it fails; False where that was tried."""
        if self.beyond:
            return False
        self.beyond, self.retries = True, 0
        return True

    @property
    def vanishing(self) -> bool:
        """True where the step has shrunk to nothing against the end time: going on would never get there."""
        return not self.dt > abs(self.end) * SMALLEST


class AutoSteps(FixedSteps):
    """Grows and shrinks with the iterations a step took, and never steps over a must point.

    A step that fails is cut by the same amount each time (or by ``cutback``), ``max_retries`` times; as in FEBio,
    dtmin bounds what follows a step that converged, not these cuts.
    After a step of N iterations with optimum M, r = sqrt(M / N): dt grows towards dtmax by
    min(0.2, r - 1) of the gap where r >= 1, else shrinks towards dtmin by 1 - r of it.
    """

    def __init__(self, step: Step, start: float, auto: AutoStep) -> None:
        super().__init__(step, start)
        self.auto = auto
        self._points: Sequence[float] = sorted(set(auto.must_points))
        if auto.repeat and self._points and not self._points[-1] > abs(self.end) * SMALLEST:
            raise ValueError(f"must points that repeat every {self._points[-1]:g} never come to an end")
        self._base = step.dt  # size before must points cut it
        self._cut = 0.0
        self._next = -1
        self._offset = 0.0
        self._must = -1

    def first(self, t: float) -> None:
        self._size(t, 0)

    def accept(self, t: float, iterations: int) -> None:
        self.retries = 0
        if t + self.end * 1e-7 < self.end:
            self._size(t, iterations)

    def go_on(self, t: float, saved: dict[str, Any]) -> None:
        self._base = saved.get("_base", self._base)
        if t + self.end * 1e-7 < self.end:
            self.first(t)

    def _limit(self, t: float) -> float:
        return float(self.auto.dtmax_curve(t)) if self.auto.dtmax_curve is not None else self.auto.dtmax

    def _size(self, t: float, iterations: int) -> None:
        a, dtmax = self.auto, self._limit(t)
        dt = max(self._base, a.dtmin)
        if a.force:
            dt = dtmax
        elif iterations > 0:
            r = sqrt(a.optimal_iterations / iterations)
            if r >= 1:
                dt = min(dt + (dtmax - dt) * min(0.2, r - 1), 5.0 * self._base)
            else:
                dt -= (dt - a.dtmin) * (1 - r)
                dt = max(dt, a.dtmin) if a.dtmin > 0 else dt
            dt = min(dt, dtmax) if dtmax > 0 else dt
        else:
            dt = max(dt, a.dtmin) if a.dtmin > 0 else dt
            dt = min(dt, dtmax) if dtmax > 0 else dt
        self._base = dt
        dt = self._before_must_point(t, dt)
        self.dt = min(dt, self.end - t)
        self.at_must_point = self._must >= 0

    def _before_must_point(self, t: float, dt: float) -> float:
        points, eps = self._points, self.end * 1e-12
        self._must = -1
        if not points:
            return dt
        self._next = max(self._next, 0)
        if self.auto.repeat and t - self._offset > FAR * points[-1]:  # not to be gone through one by one
            self._offset += floor((t - self._offset) / points[-1] - 1.0) * points[-1]
        while True:
            if self._next >= len(points):
                if not self.auto.repeat:
                    return dt
                self._offset += points[-1]
                self._next = 0
            must = points[self._next] + self._offset
            if must >= t + eps:
                break
            self._next += 1
        if must < t + dt + eps:
            self._must = self._next
            self._next += 1
            return must - t
        return dt

    def retry(self) -> bool:
        a = self.auto
        if self.retries >= (HALVINGS if self.beyond else a.max_retries):
            return False
        if self.retries == 0:
            self._cut = self.dt / (a.max_retries + 1)
        self.dt = 0.5 * self.dt if self.beyond else self.dt * a.cutback if a.aggressive else self.dt - self._cut
        self.retries += 1
        if self._must >= 0:
            self._next -= 1
            self._must = -1
        self._base = self.dt
        self.at_must_point = False
        return not self.vanishing


class ErrorSteps(AutoSteps):
    """Steps as large as an error per step of ``accuracy`` (relative) allows; must points are met, dtmax is not heeded.

    dt grows by 0.9 (accuracy / error)^(1/3), within 0.2 and 2 (Hairer, Norsett and Wanner, Solving Ordinary
    Differential Equations I, section II.4).
    """

    def __init__(self, step: Step, start: float, accuracy: float) -> None:
        super().__init__(step, start, step.auto or AutoStep(must_points=(step.dt,), repeat=True))
        if step.auto is None:  # the ends of the file's steps
            self._offset = start
        self.accuracy = accuracy
        self._last = 1.0, inf  # size and error of the last try that failed
        self._stalls = 0

    def _grown(self, error: float) -> float:
        return min(2.0, max(0.2, 0.9 * (self.accuracy / max(error, 1e-30)) ** (1 / 3)))

    def first(self, t: float) -> None:
        self._cut_at(t)

    def accept(self, t: float, iterations: int) -> None:
        self.retries = 0
        if t + self.end * 1e-7 < self.end:
            self._cut_at(t)

    def _cut_at(self, t: float) -> None:
        dt = self._before_must_point(t, self._base)
        self.dt = min(dt, self.end - t)
        self.at_must_point = self._must >= 0

    def judge(self, error: float) -> bool:
        """Is a step of the present size with this error good? The size of the next one, or of another try, is set."""
        small, tried = error <= 1.2 * self.accuracy, self.dt
        size = tried * self._grown(error) if small else tried
        if small or self._stalled(error):
            self._base = max(self._base, size) if tried < 0.99 * self._base and size > tried else size
            self._last, self._stalls = (1.0, inf), 0
            return True
        self._again(min(tried * self._grown(error), 0.5 * tried))
        return False

    def _stalled(self, error: float) -> bool:
        """Has the error hardly fallen (less than dt^(1/4)) over the last two cuts of this step?

        Then it is none of the step: pressures follow prescribed rates and displacements at once, so that what the last
        step left wrong of them is put right at the start of the next, however small that is.
        """
        dt, before = self._last
        self._stalls = self._stalls + 1 if error > before * (self.dt / dt) ** 0.25 else 0
        self._last = self.dt, error
        return self._stalls >= 2

    def retry(self) -> bool:
        if self.retries >= 20:
            return False
        self.retries += 1
        self._again(0.25 * self.dt)
        return self.dt > 1e-14 * self.end

    def _again(self, dt: float) -> None:
        if self._must >= 0:
            self._next -= 1
            self._must = -1
        self.dt = self._base = dt
        self.at_must_point = False


def stepper(step: Step, start: float, accuracy: float = 0.0) -> FixedSteps:
    if accuracy > 0.0:
        return ErrorSteps(step, start, accuracy)
    return FixedSteps(step, start) if step.auto is None else AutoSteps(step, start, step.auto)
