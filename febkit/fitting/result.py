"""What a fit gives back: values with their uncertainty, the fitted curves, and what the data could not tell."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, Where

from .methods import Ended
from .problem import Experiment, Interrupted, Problem, Stopped
from .statistics import Statistics, regression, statistics, words

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from febkit.modelling import Model

Floats = NDArray[np.float64]


class Fit:
    """A fit, done or ended early; :attr:`values` are the best that were found.

    converged, reason: whether it came to its end, and what ended it, in a sentence; interrupted: by the user; runs:
    solves of models; failures: those of them that failed; objective: the sum of weighted squares.
    """

    def __init__(self, problem: Problem, ended: Ended, *, known: bool = False, interrupted: bool = False,
                 seconds: float = 0.0) -> None:  # fmt: skip
        assert problem.best is not None
        self._problem = problem
        self.converged, self.reason, self.interrupted = ended.converged, ended.reason, interrupted
        self.runs, self.failures, self.seconds = problem.runs, problem.failures, seconds
        self.names = list(problem.parameters.names)
        self._z = problem.best.z
        self.objective = problem.best.objective
        self.curves = [made.copy() for made in problem.predictions(self._z) or []]
        self.statistics: Statistics | None = None
        if ended.J is not None and np.array_equal(ended.z, self._z):
            self.statistics = statistics(problem.parameters, self._z, problem.residuals(self._z), ended.J, known)

    # ---- values -------------------------------------------------------------------------------------
    @property
    def values(self) -> dict[str, float]:
        """The fitted parameters by name."""
        return dict(zip(self.names, map(float, self._problem.parameters.values(self._z))))

    def __getitem__(self, name: str) -> float:
        return self.values[name]

    def settings(self, experiment: str | None = None) -> dict[str, float]:
        """Value of every path of an experiment's model (the first by default), tied ones too."""
        p = self._problem.parameters
        return p.settings(p.values(self._z), self._experiment(experiment).name)

    def model(self, experiment: str | None = None) -> Model:
        """The model of an experiment (the first by default) with the fitted values."""
        out: Model = self._experiment(experiment).model.copy()
        for path, value in self.settings(experiment).items():
            out[path] = value
        return out

    def _experiment(self, name: str | None) -> Experiment:
        for e in self._problem.experiments:
            if name in (None, e.name):
                return e
        raise InputError(f"no experiment is called {name!r}; there are "
                         f"{', '.join(e.name for e in self._problem.experiments)}")  # fmt: skip

    def _needed(self) -> Statistics:
        if self.statistics is None:
            raise InputError(f"the fit has no derivatives at its end, so no covariance: {self.reason}")
        return self.statistics

    @property
    def covariance(self) -> pd.DataFrame:
        return self._square(self._needed().covariance)

    @property
    def correlation(self) -> pd.DataFrame:
        return self._square(self._needed().correlation)

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """95 % confidence intervals by name; nan where there is none to be had."""
        s = self._needed()
        return {n: (float(a), float(b)) for n, a, b in zip(self.names, s.low, s.high)}

    @property
    def identifiability(self) -> list[str]:
        """What the data do not tell, a sentence each; empty where they tell all."""
        return words(self._needed(), self.names)

    @property
    def R2(self) -> dict[str, float]:
        """Regression coefficient of each experiment."""
        return {e.name: regression(e.y, made) for e, made in zip(self._problem.experiments, self.curves)}

    def _square(self, a: Floats) -> pd.DataFrame:
        import pandas as pd

        return pd.DataFrame(a, self.names, self.names)

    # ---- for reading --------------------------------------------------------------------------------
    @property
    def table(self) -> pd.DataFrame:
        """A row for each parameter: value, standard deviation, interval, bounds."""
        import pandas as pd

        p = self._problem.parameters
        columns: dict[str, Any] = {"value": p.values(self._z)}
        if self.statistics is not None:
            columns |= {"deviation": self.statistics.deviations, "low 95 %": self.statistics.low,
                        "high 95 %": self.statistics.high}  # fmt: skip
        columns |= {"from": [q.low for q in p.every], "to": [q.high for q in p.every]}
        return pd.DataFrame(columns, self.names)

    def said(self) -> list[str]:
        """The fit in sentences, below its table."""
        end = "fitted" if self.converged else "stopped"
        failed = f", {self.failures} of which failed" if self.failures else ""
        out = [f"{end}: {self.reason}; {self.runs} runs{failed}, {self.seconds:.2f} s"]
        out += [f"{name}: R^2 = {r:.6g}" for name, r in self.R2.items()]
        if self.statistics is not None:
            out += self.identifiability or ["the data tell all parameters apart"]
        return out

    def __bool__(self) -> bool:
        return self.converged

    def __repr__(self) -> str:
        return "\n".join([self.table.to_string(float_format=lambda v: f"{v:.6g}"), *self.said()])

    def _repr_html_(self) -> str:
        from html import escape

        said = "".join(f"<li>{escape(line)}</li>" for line in self.said())
        return f"{self.table.to_html(float_format=lambda v: f'{v:.6g}')}<ul>{said}</ul>"

    def data(self) -> pd.DataFrame:
        """What was measured and what is fitted: experiment, observed, x, measured, fitted, residual (weighted)."""
        import pandas as pd

        parts = [
            pd.DataFrame({"experiment": e.name, "observed": [n for n, many in e.observed for _ in range(many)],
                          "x": e.x, "measured": e.y, "fitted": made, "residual": e.weight * (made - e.y)})
            for e, made in zip(self._problem.experiments, self.curves)
        ]  # fmt: skip
        return pd.concat(parts, ignore_index=True)

    def axis(self, experiment: str) -> str:
        """What x of an experiment is."""
        return self._experiment(experiment).axis

    def plot(self, experiments: Sequence[str] | None = None) -> Figure:
        """Measured and fitted curves with their residuals below: see :func:`febkit.plots.fitted`."""
        from febkit.plots.residuals import fitted

        out: Figure = fitted(self, experiments)
        return out


def finished(problem: Problem, solve: Callable[[], Ended], where: Where | None = None, known: bool = False) -> Fit:
    """What a method comes to; where it has to stop, the best until then.

    Raises InputError where the model does not solve at its starting values, KeyboardInterrupt before they are tried.
    """
    began, interrupted = perf_counter(), False
    try:
        ended = solve()
    except Stopped as e:
        interrupted = isinstance(e, Interrupted)
        if problem.best is None:
            raise (KeyboardInterrupt if interrupted else InputError(str(e), where)) from None
        ended = Ended(problem.best.z, False, str(e))
    return Fit(problem, ended, known=known, interrupted=interrupted, seconds=perf_counter() - began)
