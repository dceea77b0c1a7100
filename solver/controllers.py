"""Load controllers: functions of time given by points or by a formula.

Load curves follow FEBio's to the last rule (FEBio User Manual, "Load curves"), among them: a step curve
takes the value of the point *after* t, also where t is a point's own time, except at both ends.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import field
from math import fmod, inf
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .record import variable_record

Floats = NDArray[np.float64]
Function = Callable[[float], float]

INTERPOLATIONS = (
    "linear", "step", "smooth", "cubic spline", "control points", "approximation", "smooth step", "c2 smooth",
)
EXTENSIONS = ("constant", "extrapolate", "repeat", "repeat offset")
TURNS = 1000  # periods of a curve that repeats, beyond which they are not counted one by one


def _known(text: str, names: Sequence[str], what: str) -> str:
    name = text.strip().lower().replace("-", " ").replace("_", " ")
    if name.isdigit() and int(name) < len(names):
        return names[int(name)]
    if name not in names:
        raise ValueError(f'{what} "{text}" is unknown; it may be {", ".join(names)}')
    return name


@variable_record
class LoadCurve:
    """A value in time through ``points`` (n, 2) of times and values, in order of time.

    Raises ValueError for an interpolation or extension of another name, times that go back, and nan or inf.
    """

    points: ArrayLike
    interpolate: str = "linear"
    extend: str = "constant"
    times: Floats = field(init=False, repr=False)
    values: Floats = field(init=False, repr=False)
    _between: Function = field(init=False, repr=False)

    def __post_init__(self) -> None:
        p = np.asarray(self.points, dtype=float).reshape(-1, 2)
        self.times, self.values = p[:, 0].copy(), p[:, 1].copy()
        if (np.diff(self.times) < 0).any():
            raise ValueError("the times of a load curve must not go back")
        if not np.isfinite(p).all():
            raise ValueError("the points of a load curve must be finite numbers")
        self.interpolate = _known(self.interpolate, INTERPOLATIONS, "interpolation")
        self.extend = _known(self.extend, EXTENSIONS, "extension")
        if len(p) > 1:
            self._between = _INTERPOLATE[self.interpolate](self.times, self.values)

    def __call__(self, t: float) -> float:
        x, y = self.times, self.values
        if len(x) < 2:
            return float(y[0]) if len(x) else 0.0
        if t == x[0]:
            return float(y[0])
        if t == x[-1]:
            return float(y[-1])
        if t < x[0] or t > x[-1]:
            return self._outside(t)
        return float(self._between(t))

    def _outside(self, t: float) -> float:
        x, y = self.times, self.values
        length = x[-1] - x[0]
        if length == 0.0:
            return float(y[0])
        if self.extend == "extrapolate":
            return self._extrapolated(t)
        if self.extend.startswith("repeat"):
            t, turns = _wrapped(t, float(x[0]), float(x[-1]))
            return self(t) + (turns * (y[-1] - y[0]) if self.extend == "repeat offset" else 0.0)
        return float(y[0] if t < x[0] else y[-1])

    def _extrapolated(self, t: float) -> float:
        """Along the end tangents, taken over a thousandth of the curve where it is not piecewise linear."""
        x, y = self.times, self.values
        first = t < x[0]
        if self.interpolate in ("step", "smooth step"):
            return float(y[0] if first else y[-1])
        if self.interpolate == "linear":
            i = 0 if first else len(x) - 2
            return _line(t, x[i], y[i], x[i + 1], y[i + 1])
        h = 0.001 * (x[-1] - x[0])
        if first:
            return _line(t, x[0], y[0], x[0] + h, self(x[0] + h))
        return _line(t, x[-1] - h, self(x[-1] - h), x[-1], y[-1])


def _wrapped(t: float, first: float, last: float) -> tuple[float, float]:
    """A time outside [first, last] moved into it by whole periods, and how many (negative before ``first``).

    Up to TURNS periods are taken off one by one, as FEBio does: on which side of a saw's jump a time falls that meets
    a point is decided by the rounding of these differences. Beyond, by the remainder of the division.
    """
    period = last - first
    if abs(t - first) > TURNS * period:
        rest = fmod(t - first, period)
        if rest < 0.0 or (rest == 0.0 and t > last):  # a period's end belongs to the period before it
            rest += period
        return min(first + rest, last), (t - first - rest) / period
    turns = 0
    while t < first:
        t, turns = t + period, turns - 1
    while t > last:
        t, turns = t - period, turns + 1
    return t, turns


def _line(t: float, t0: float, f0: float, t1: float, f1: float) -> float:
    return float(f0 + (f1 - f0) * (t - t0) / (t1 - t0))


def _parabola(t: float, x: Floats, y: Floats) -> float:
    """The parabola through three points."""
    a, b, c = x
    return float(
        y[0] * (c - t) * (b - t) / ((c - a) * (b - a))
        + y[1] * (c - t) * (t - a) / ((c - b) * (b - a))
        + y[2] * (t - b) * (t - a) / ((c - b) * (c - a))
    )


def _after(x: Floats, t: float) -> int:
    """The first point after t."""
    return int(np.searchsorted(x, t, side="right"))


def _linear(x: Floats, y: Floats) -> Function:
    times, values = x.tolist(), y.tolist()

    def value(t: float) -> float:
        n = bisect_right(times, t)
        return _line(t, times[n - 1], values[n - 1], times[n], values[n])

    return value


def _step(x: Floats, y: Floats) -> Function:
    return lambda t: float(y[_after(x, t)])


def _smooth_step(x: Floats, y: Floats) -> Function:
    """f0 + (f1 - f0) w^3 (10 - 15 w + 6 w^2) between two points."""

    def value(t: float) -> float:
        n = _after(x, t)
        w = (t - x[n - 1]) / (x[n] - x[n - 1])
        return float(y[n - 1] + (y[n] - y[n - 1]) * w**3 * (10.0 - 15.0 * w + 6.0 * w * w))

    return value


def _smooth(x: Floats, y: Floats) -> Function:
    """Parabolas through three points each, blended linearly over the interval two of them share."""

    def value(t: float) -> float:
        if len(x) == 2:
            return _line(t, x[0], y[0], x[1], y[1])
        n = _after(x, t)
        left = _parabola(t, x[n - 2 : n + 1], y[n - 2 : n + 1]) if n > 1 else None
        right = _parabola(t, x[n - 1 : n + 2], y[n - 1 : n + 2]) if n < len(x) - 1 else None
        if left is None or right is None:
            return left if right is None else right  # type: ignore[return-value]
        return _line(t, x[n - 1], left, x[n], right)

    return value


def _knots(order: int, x: Floats) -> Floats:
    """Knots from break points: in the interior the points themselves, or their means at odd order."""
    n, half = len(x), order // 2
    i = np.arange(order, n)
    inner = x[i - half] if order % 2 == 0 else 0.5 * (x[i - half] + x[i - 1 - half])
    return np.concatenate([np.full(order, x[0]), inner, np.full(order, x[-1])])


def _spline(x: Floats, coefficients: Floats, order: int) -> Function:
    from scipy.interpolate import BSpline

    f = BSpline(_knots(order, x), coefficients, order - 1)
    return lambda t: float(f(t))


def _control_points(x: Floats, y: Floats) -> Function:
    return _spline(x, y, min(len(x), 4))


def _fitted(x: Floats, y: Floats, breaks: Floats, order: int) -> Function:
    from scipy.interpolate import BSpline

    A = BSpline.design_matrix(x, _knots(order, breaks), order - 1).toarray()
    return _spline(breaks, np.asarray(np.linalg.lstsq(A, y, rcond=None)[0], dtype=np.float64), order)


def _cubic_spline(x: Floats, y: Floats) -> Function:
    return _fitted(x, y, x, min(len(x), 4))


def _approximation(x: Floats, y: Floats) -> Function:
    """Least squares by half as many coefficients."""
    m = len(x) // 2 + 1
    return _fitted(x, y, x if m == len(x) else np.linspace(x[0], x[-1], m), min(m, 4))


_INTERPOLATE: dict[str, Callable[[Floats, Floats], Function]] = {
    "linear": _linear, "step": _step, "smooth": _smooth, "cubic spline": _cubic_spline,
    "control points": _control_points, "approximation": _approximation, "smooth step": _smooth_step,
    "c2 smooth": _smooth,
}

Extension = Literal["zero", "constant", "repeat"]


@variable_record
class Interval:
    """A function of time on an interval, extended on either side (FEBio's "math-interval" controller)."""

    function: Function
    interval: tuple[float, float] = (0.0, 1.0)
    left: Extension = "constant"
    right: Extension = "constant"

    def __post_init__(self) -> None:
        a, b = self.interval
        if not a < b < inf or a == -inf:
            raise ValueError(f"the interval must have an end after its start, not {a:g} to {b:g}")

    def __call__(self, t: float) -> float:
        a, b = self.interval
        if t <= a:
            if self.left == "zero":
                return 0.0
            t = a if self.left == "constant" else b - fmod(a - t, b - a)
        elif t >= b:
            if self.right == "zero":
                return 0.0
            t = b if self.right == "constant" else a + fmod(t - a, b - a)
        return float(self.function(t))
