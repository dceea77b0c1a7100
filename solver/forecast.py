"""What a vector grows by in a time step, told from the steps before: where steps and variations begin to look."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .kernels.vectors import add
from .vectors import dot, norm

Floats = NDArray[np.float64]
STEPS = 6  # before the present one that are looked at
MANY = 1000  # unknowns of a field from which it is learnt
CALM = 3  # steps in which no guess is taken from one that was cut on
NEAR = 0.25  # relative error of the last step's guess up to which the next is trusted
FADE = 0.3  # what counts of the steps before the last one in what is learnt


class Past:
    """What a vector grew by in the last steps."""

    def __init__(self) -> None:
        self.steps: list[tuple[float, Floats]] = []  # length and growth

    def add(self, dt: float, x: Floats) -> None:
        self.steps = [*self.steps[1 - STEPS :], (dt, x)]

    def led(self, dt: float, n: int) -> tuple[Floats, Floats]:
        """Growth (n,) in a step dt at the mean rate of the last steps, and by its trend: (rate - rate before) / length.

        As many steps make one as are at least half as long as dt: rates over less are too rough. A rate is that of the
        end of a step, as backward Euler has it.
        """
        spans: list[tuple[float, Floats]] = []
        for h, x in reversed(self.steps):
            if spans and spans[-1][0] < 0.5 * dt:
                spans[-1] = spans[-1][0] + h, spans[-1][1] + x
            elif len(spans) < 2:
                spans.append((h, x))
            else:
                break
        if not spans:
            return np.zeros(n), np.zeros(n)
        length, rate = spans[0][0], spans[0][1] / spans[0][0]
        if len(spans) < 2:
            return dt * rate, np.zeros(n)
        return dt * rate, (dt * dt / length) * (rate - spans[1][1] / spans[1][0])


class Guess:
    """What the unknowns grow by in a step: at their mean rate in the last ones, and as much of its trend as was right.

    ``fields``: the unknowns of each field, which count alike.
    """

    def __init__(self, n: int, fields: list[NDArray[np.int64]]) -> None:
        self._n, self._fields, self._past = n, fields, Past()
        self._given: tuple[float, Floats] = (1.0, np.zeros(n))  # the last step, and what prescribed unknowns grew by
        self._told: Floats | None = None  # of the present step,
        self._mean = self._trend = self._given[1]  # and what it is made of
        self._fit = (0.0, 0.0)  # of the trend: products with what was right, and with itself
        self._near = False  # was the last step's?
        self._wait = 0  # steps that it is not to be trusted whatever it tells

    def __call__(self, dt: float, given: Floats) -> Floats | None:
        """What they grow by in a step dt; None where it is not to be trusted. ``given``: what prescribed ones do."""
        self._told = None
        length, last = self._given
        self._given = dt, given
        if len(self._past.steps) < 2:
            return None
        mean, trend = self._past.led(dt, self._n)
        right, own = self._fit
        self._told = mean + (min(max(right / own, 0.0), 1.0) if own else 0.0) * trend
        self._mean, self._trend = mean, trend
        steady = norm(given - (dt / length) * last) <= NEAR * norm(given)
        return self._told if self._near and steady and not self._wait else None

    def doubt(self) -> None:
        """A step was cut: where the size of steps decides over the answer, they begin where FEBio's do."""
        self._wait = CALM

    def learn(self, dt: float, x: Floats) -> None:
        """The step dt is over, in which they grew by x."""
        if self._told is not None:
            right, own, error = FADE * self._fit[0], FADE * self._fit[1], 0.0
            for f in self._fields:
                size, t = norm(x[f]), self._trend[f]
                if size > 0.0:
                    right += dot(t, x[f] - self._mean[f]) / size**2
                    own += dot(t, t) / size**2
                    error = max(error, norm(x[f] - self._told[f]) / size)
            self._fit, self._near = (right, own), error < NEAR
        else:
            self._near = len(self._past.steps) > 0
        self._wait = max(0, self._wait - 1)
        self._past.add(dt, x)

    def snapshot(self) -> tuple[Any, ...]:
        return list(self._past.steps), self._fit, self._near, self._wait, self._given

    def restore(self, saved: tuple[Any, ...]) -> None:
        steps, self._fit, self._near, self._wait, self._given = saved
        self._past.steps, self._told = list(steps), None


class Forecast:
    """Of derivatives of a run: their mean rate and, where it ``learns``, as much of its trend and of what the run
    itself does beside its own mean and trend as was right in the last steps, by least squares in which fields count
    alike."""

    def __init__(self, fields: list[NDArray[np.int64]], n: int, learns: bool) -> None:
        self._some, self._n, self._past = [f[:: max(1, len(f) // MANY)] for f in fields], n, Past()
        self._G, self._b = np.zeros((3, 3)), np.zeros(3)
        self._learns, self._led = learns, (np.zeros(n), [np.zeros(n)] * 3)

    def __call__(self, dt: float, beside: Floats, bend: Floats) -> Floats:
        """x (n,) in a step dt in which the run grows by ``beside`` more than at its mean rate, by ``bend`` in trend."""
        mean, trend = self._past.led(dt, self._n)
        if not self._learns:
            return mean
        self._led = mean, [trend, beside, bend]
        out = mean.copy()
        for c, term in zip(np.linalg.lstsq(self._G, self._b, rcond=1e-10)[0], self._led[1]):
            add(float(c), term, out)
        return out

    def learn(self, dt: float, x: Floats) -> None:
        """The step dt is over, in which it grew by x."""
        if self._past.steps and self._learns:
            self._G, self._b = FADE * self._G, FADE * self._b
            mean, terms = self._led
            for f in self._some:
                T, y = np.array([q.take(f) for q in terms]), x.take(f) - mean.take(f)
                grown = norm(self._past.steps[-1][1].take(f))
                if grown > 0.0:
                    w = 1.0 / grown**2
                    self._G += w * np.einsum("ir,jr->ij", T, T)
                    self._b += w * np.einsum("ir,r->i", T, y)
        self._past.add(dt, x)
