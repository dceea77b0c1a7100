"""Runs an optimisation file of FEBio's on a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import Model, Output

from . import grid, methods
from .methods import Ended, Tolerance
from .optimise import Optimise, read
from .parameters import Parameters
from .probes import Follow, parameter
from .problem import Failed, Made, Problem, Trial
from .result import Fit, finished

if TYPE_CHECKING:
    from febkit.modelling import Model as Editable

Floats = NDArray[np.float64]
CLOSE = 1e-4  # relative step of parameters from which on a fit is done, where the file's tolerance is no smaller


class Followed:
    """A model with the objective of an optimisation file: an :class:`.problem.Experiment`.

    ``options`` are those of :func:`febkit.solve`. The model writes nothing while it is fitted.
    """

    name = "data"

    def __init__(self, model: Editable, file: Optimise, options: Mapping[str, Any]) -> None:
        self.model, self.objective, self.options = model, file.objective, options
        self.x, self.y, self.weight = file.objective.x, file.objective.y, np.ones(len(file.objective.y))
        self.observed, self.axis = [(file.objective.name, len(self.y))], file.objective.axis
        self._silent = model.copy()
        self._silent._put(output=replace(model.record.output or Output(), log=()))

    def predict(self, settings: Mapping[str, float], ends: Sequence[float] | None = None, beside: bool = False) -> Made:
        rows, own = self.rows(settings, ends)
        return Made(np.asarray(self.objective.evaluate(rows)), own)

    def tighten(self, much: bool = True) -> bool:
        """FEBio's fits take the file's tolerances."""
        return False

    def rows(self, settings: Mapping[str, float], ends: Sequence[float] | None = None) -> tuple[Floats, list[float]]:
        """(state, probe) what is followed of a run, and the ends of its time steps."""
        from febkit.solving import solve

        m = self._silent.copy()
        for path, value in settings.items():
            m[path] = value
        record = m.record if ends is None else grid.on(m.record, ends)
        follow, times = Follow(record, self.objective.probes), grid.Times(record)
        with m._again.lent() as again:
            result = solve(record, listeners=[follow, times], warn=lambda _: None, graph=again.graphs, **self.options)
        if result.interrupted:
            raise KeyboardInterrupt
        if not result.converged:
            raise Failed(result.reason)
        return np.array(follow.rows), times.ends


def fit(path: str | PathLike[str], model: Model | Editable, tell: Callable[[Trial], None] | None = None,
        **options: Any) -> Fit:  # fmt: skip
    """Fit a model by an optimisation file; ``options`` are those of :func:`febkit.solve`.

    Raises InputError where the file is none, or names what the model has not.
    """
    file = read(path)
    return carried_out(file, posed(file, model, tell, **options))


def posed(file: Optimise, model: Model | Editable, tell: Callable[[Trial], None] | None = None,
          **options: Any) -> Problem:  # fmt: skip
    """The problem of a file. Raises InputError where its parameters are no numbers of the model."""
    from febkit.modelling import Model as Editable

    own = Editable.of(model)
    for p, where in zip(file.parameters, file.lines):
        parameter(own.record, p.name, where)
    step = file.options.get("f_diff_scale", 1e-3)
    return Problem(Parameters(file.parameters), [Followed(own, file, options)], step=step, tell=tell)


def carried_out(file: Optimise, problem: Problem) -> Fit:
    """The fit that a file asks for."""
    return finished(problem, lambda: _solved(file, problem), file.where)


def _solved(file: Optimise, problem: Problem) -> Ended:
    tolerance = file.options.get("obj_tol", 1e-3)
    small = Tolerance(tolerance, min(CLOSE, tolerance**0.5))
    if file.method == "scan":
        return methods.scan(problem, [p.scale or 1.0 for p in file.parameters])
    if file.method == "powell":
        return methods.powell(problem, small)
    most = int(file.options.get("max_iter", 100))
    if not len(file.b):
        return methods.least_squares(problem, small, most)
    ended = methods.least_squares(problem, small, most, file.A, file.b)
    return replace(ended, J=None)  # which is of all directions, those that the constraints shut too
