"""Derivatives of plot variables by parameters: in memory, as plotfiles hold values."""

from __future__ import annotations

import numpy as np

from febkit.files import Buffer
from febkit.model import Model
from febkit.solver.result import Result
from febkit.solver.run import Listener, Run
from febkit.solver.sensitivity import Sensitivities

from . import plot
from .plotfile import Floats, PlotListener

Values = list[dict[int, Floats]]


def _quotient(a: Values, b: Values, delta: float) -> Values:
    return [{r: (v - y[r]) / delta for r, v in x.items() if r in y} for x, y in zip(a, b)]


class Derivatives(Listener):
    """Of what a run saves, by the parameters of ``sensitivities``, which is told of the run's events before this.

    ``buffer`` has a state for each parameter and each saved state, by parameters first; where a parameter has no
    derivatives, those of nothing.
    """

    def __init__(self, model: Model, sensitivities: Sensitivities) -> None:
        self.model, self.sensitivities = model, sensitivities
        self.buffer = Buffer()
        self.plot = PlotListener(model, self.buffer, lambda _: None)
        self._views: dict[Run, plot.View] = {}
        self._nodal = all(asked.name in plot.NODAL for asked, _ in self.plot.asked)

    def save(self, run: Run, status: int) -> None:
        if not self.sensitivities.varied:
            return
        base = self._values(run)
        for k in range(len(self.sensitivities.varied)):
            lost = self.sensitivities.lost(k)
            high, low, delta = (run, run, 1.0) if lost else self.sensitivities.ends(k, self._nodal)
            a, b = (base if r is run else self._values(r) for r in (high, low))
            self.plot.write(run, _quotient(a, b, delta), status)

    def _values(self, run: Run) -> Values:
        if run not in self._views:
            self._views[run] = plot.View(run, self.model, self.plot.mesh)
        return self.plot.values(self._views[run])

    def end(self, run: Run, result: Result) -> None:
        self.plot.end(run, result)


class Kept(PlotListener):
    """Values of a run, state by state."""

    def __init__(self, model: Model) -> None:
        super().__init__(model, Buffer(), lambda _: None)
        self.kept: list[Values] = []

    def write(self, run: Run, values: Values, status: int) -> None:
        self.kept.append([{r: np.array(v) for r, v in found.items()} for found in values])


class Difference(PlotListener):
    """What a run saves less what another one did (``other``), over ``delta``."""

    def __init__(self, model: Model, other: list[Values], delta: float) -> None:
        self.buffer = Buffer()
        super().__init__(model, self.buffer, lambda _: None)
        self._other, self._delta = iter(other), delta

    def write(self, run: Run, values: Values, status: int) -> None:
        other = next(self._other, None)
        if other is not None:
            super().write(run, _quotient(values, other, self._delta), status)
