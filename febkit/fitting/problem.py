"""The question of a fit: residuals of all experiments at any parameters, their derivatives, and what was tried."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from .parameters import Parameters

if TYPE_CHECKING:
    from febkit.modelling import Model

Floats = NDArray[np.float64]


class Made(NamedTuple):
    """What a model shows (n,), the ends of its time steps, and derivatives (n,) by path where the run brings them."""

    found: Floats
    ends: list[float] = []
    by: Mapping[str, Floats] = {}


class Failed(Exception):
    """A model that did not solve; the message says why."""


class Stopped(Exception):
    """The fit has to end before it is done; the message says why."""


class Interrupted(Stopped):
    """By the user."""


class Experiment(Protocol):
    """What was measured, and the model that ought to show it.

    name; model: as it was given; x, y: (n,) where and what was measured; weight: (n,) of differences from it;
    observed: names of the curves and how many points each has; axis: what x is.
    """

    name: str
    model: Model
    x: Floats
    y: Floats
    weight: Floats
    observed: list[tuple[str, int]]
    axis: str

    def predict(self, settings: dict[str, float], ends: Sequence[float] | None = None, beside: bool = False) -> Made:
        """What the model shows with these values at its paths; ``ends``: time steps that it takes, of another run;
        ``beside``: for a difference, of which derivatives are not asked. Raises Failed where it does not solve."""

    def tighten(self, much: bool = True) -> bool:
        """Solve to tighter tolerances from here on, or to the model's own again; False where that changes nothing."""


@dataclass(frozen=True, slots=True)
class Trial:
    """One set of values, and how well it does: objective = sum of weighted squares, inf where a model failed."""

    number: int
    z: Floats
    values: Floats
    objective: float
    failure: str = ""


class Problem:
    """Residuals r(z) = weight (model - data) of all experiments, one after the other.

    ``runs`` counts solves of models; ``best`` is the best trial so far; ``step``: of differences, in the optimiser's
    units; ``most``: runs after which the fit is stopped; ``tell`` hears of each trial.
    """

    def __init__(self, parameters: Parameters, experiments: Sequence[Experiment], *, step: float = 1e-3,
                 most: int = 0, tell: Callable[[Trial], None] | None = None) -> None:  # fmt: skip
        self.parameters, self.experiments = parameters, list(experiments)
        self.step, self.most, self.tell = step, most, tell
        self.runs = self.trials = self.failures = 0
        self.best: Trial | None = None
        self.why = ""  # the last failure
        self._known: dict[bytes, list[Made]] = {}
        self._ends: list[list[float] | None] = [None] * len(self.experiments)

    @property
    def data(self) -> Floats:
        return np.concatenate([e.y for e in self.experiments])

    @property
    def weight(self) -> Floats:
        return np.concatenate([e.weight for e in self.experiments])

    def predictions(self, z: Floats) -> list[Floats] | None:
        """What each experiment shows, None where a model fails (:attr:`why`)."""
        made = self._made(z)
        return None if made is None else [m.found for m in made]

    def hold_steps(self, z: Floats, beside: bool = False) -> bool:
        """Have all runs from here on take the time steps that they take at z by themselves; False where they do so.

        ``beside``: derivatives are not asked of the runs at z. Adaptive steps follow parameters by jumps, and so do
        curves, by the error of their steps: no way to derivatives.
        """
        known = self._known.get(z.tobytes())
        held, self._ends = self._ends, [None] * len(self.experiments)
        if known is not None and any(held):
            del self._known[z.tobytes()]
        made = self._made(z, beside)
        if made is None:
            self._ends = held
            return False
        self._ends = [m.ends or None for m in made]
        if all(map(_same, held, self._ends)):
            return False
        self._known = {z.tobytes(): made}
        self.best = self._trial(z, made)
        return True

    def tighten(self, z: Floats) -> bool:
        """Have models solved to tighter tolerances from here on; False where all are, or do not solve to them at z."""
        changed = [e for e in self.experiments if e.tighten()]
        if not changed:
            return False
        known, best = self._known, self.best
        self._known, self.best = {}, None
        if self._made(z) is None:
            self._known, self.best = known, best
            for e in changed:
                e.tighten(False)
        return self._known is not known

    def forget(self, z: Floats) -> None:
        """Runs at z are made again where they are asked for."""
        self._known.pop(z.tobytes(), None)

    def _made(self, z: Floats, beside: bool = False) -> list[Made] | None:
        key = z.tobytes()
        if key not in self._known:
            values = self.parameters.values(z)
            self.trials += 1
            try:
                made = [self._run(e, values, ends, beside) for e, ends in zip(self.experiments, self._ends)]
            except Failed as e:
                self.failures += 1
                self.why = str(e)
                self._tried(Trial(self.trials, z.copy(), values, math.inf, self.why))
                return None
            self._known[key] = made
            self._tried(self._trial(z, made))
            for old in list(self._known)[:-20]:
                del self._known[old]
        return self._known[key]

    def residuals(self, z: Floats) -> Floats:
        """(m,) weighted differences; nan where a model fails, which has optimisers step back."""
        made = self.predictions(z)
        if made is None:
            return np.full(len(self.data), np.nan)
        return np.asarray(self.weight * (np.concatenate(made) - self.data))

    def objective(self, z: Floats) -> float:
        """Sum of squares of the residuals, a large number where a model fails."""
        r = self.residuals(z)
        f = float(r @ r)
        worst = self.best.objective if self.best is not None else 1.0
        return f if math.isfinite(f) else 1e3 * max(worst, 1e-300) + 1.0

    def jacobian(self, z: Floats, old: Floats | None = None) -> Floats:
        """(m, n) dr/dz: exact where a run has brought derivatives, else by one-sided differences.

        A run that fails, or cuts a time step that the present one does not, is tried on the other side, then with a
        quarter of the step. ``old``: of parameters at their bounds its columns do.
        """
        wanted = np.ones(len(z), bool) if old is None else self.free(z)
        made = self._made(z)
        if made is None:
            raise Stopped(self.why)
        values, rows = self.parameters.values(z), []
        for e, m in zip(self.experiments, made):
            slopes = self.parameters.slopes_of(values, e.name)
            if slopes.keys() <= m.by.keys():
                J = sum(np.outer(m.by[path], slope) for path, slope in slopes.items())
            else:
                none = np.zeros(len(m.found))
                J = np.column_stack([self._difference(e, z, k, m) if w else none for k, w in enumerate(wanted)])
            rows.append(e.weight[:, None] * J)
        out = np.vstack(rows)
        if old is not None and not self.brings_derivatives(z):
            out[:, ~wanted] = old[:, ~wanted]
        return out

    def free(self, z: Floats) -> NDArray[np.bool_]:
        """(n,) which parameters are within their bounds."""
        return np.asarray((z > self.parameters.low) & (z < self.parameters.high))

    def brings_derivatives(self, z: Floats) -> bool:
        """Have the runs at z brought all derivatives?"""
        made, values = self._made(z) or [], self.parameters.values(z)
        return bool(made) and all(
            self.parameters.slopes_of(values, e.name).keys() <= m.by.keys() for e, m in zip(self.experiments, made)
        )

    def _difference(self, e: Experiment, z: Floats, k: int, old: Made) -> Floats:
        if not self.parameters.concern(e.name)[k]:
            return np.zeros(len(old.found))
        h = self.step * max(1.0, abs(z[k])) if not self.parameters.every[k].log else self.step
        room = self.parameters.high[k] - z[k]
        found: Floats | None = None
        for dz in (h, -h, 0.25 * h, -0.25 * h) if room >= h else (-h, -0.25 * h):
            at = z.copy()
            at[k] = np.clip(at[k] + dz, self.parameters.low[k], self.parameters.high[k])
            if at[k] == z[k]:
                continue
            try:
                new = self._run(e, self.parameters.values(at), old.ends, beside=True)
            except Failed as failure:
                self.failures += 1
                self.why = str(failure)
                continue
            found = np.asarray((new.found - old.found) / (at[k] - z[k]))
            if _same(old.ends, new.ends):
                break
        if found is not None:
            return found
        raise Stopped(f"{self.parameters.names[k]}: no run beside the present values solves: {self.why}")

    def _trial(self, z: Floats, made: list[Made]) -> Trial:
        r = self.weight * (np.concatenate([m.found for m in made]) - self.data)
        return Trial(self.trials, z.copy(), self.parameters.values(z), float(r @ r))

    def _run(self, e: Experiment, values: Floats, ends: list[float] | None, beside: bool = False) -> Made:
        if self.most and self.runs >= self.most:
            raise Stopped(f"{self.most} runs are made")
        self.runs += 1
        try:
            made = e.predict(self.parameters.settings(values, e.name), ends or None, beside)
        except KeyboardInterrupt:
            raise Interrupted("interrupted") from None
        if not np.isfinite(made.found).all():
            raise Failed(f"{e.name}: what is compared is no number")
        return made

    def _tried(self, trial: Trial) -> None:
        if math.isfinite(trial.objective) and (self.best is None or trial.objective < self.best.objective):
            self.best = trial
        if self.tell is not None:
            self.tell(trial)


def _same(a: list[float] | None, b: list[float] | None) -> bool:
    """Are these the ends of the same time steps?"""
    if a is None or b is None:
        return a is b
    return len(a) == len(b) and bool(np.allclose(a, b, rtol=1e-9, atol=0.0))
