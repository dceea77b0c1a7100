"""One experiment: a model, what is observed of it, and what was measured."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, as_record
from febkit.observe import Observable, observable, observables, variables

from . import grid
from .data import columns
from .problem import Failed, Made

if TYPE_CHECKING:
    import xarray as xr

    from febkit.modelling import Model
    from febkit.modelling.solution import Solution
    from febkit.observe import Follow, Observe
    from febkit.solver.problem import Problem as LoweredProblem

    from .parameters import Spec

Floats = NDArray[np.float64]
LARGE = 100  # elements from which derivatives cost less than the run: 1.3 to 1.7 runs for three of them
TIGHT = 1e-6  # relative increments of models whose curves do not do what their derivatives promise
MET = 400  # times of data up to which a run meets each of them


@dataclass
class Experiment:
    """What was measured, and the model that ought to show it.

    model: a model, or the path of a .feb file; data: see :func:`.data.columns`; observe: what the data are, in words or
    by functions (:mod:`febkit.observe`); against: the observable that is x of the data, time where it is left out.
    sigma: standard deviation of the data, a number, one for each observable, or of each point; where it is not known,
    curves count by their greatest value. parameters: those of this experiment alone; settings: values that its model
    is given by path. meet: the run meets the data's times (the default up to 400 of them); else curves between saved
    states are straight.
    """

    model: Model | str | PathLike[str]
    data: Any
    observe: Observe
    against: str | Follow | None = None
    sigma: Any = None
    parameters: Mapping[Any, Spec] = field(default_factory=dict)
    settings: Mapping[str, float] = field(default_factory=dict)
    name: str = ""
    meet: bool | None = None


class Measured:
    """An experiment made ready: an :class:`.problem.Experiment`. ``options`` are those of :func:`febkit.solve`."""

    def __init__(self, given: Experiment, name: str, options: Mapping[str, Any], exact: bool | None = None) -> None:
        from febkit.lower import lower

        self.name, self.options = name, {"tolerance": 0.0, **options}
        self._asked: float = self.options["tolerance"]
        self.model = _model(given.model)
        for path, value in given.settings.items():
            self.model[path] = value
        try:
            self.observables = observables(given.observe)
        except InputError as e:
            raise InputError(f"{name}: observe: {e.message}", e.where) from None
        self.against: Observable | None = None if given.against is None else observable(given.against)
        try:
            self.curves = columns(given.data, list(self.observables))
        except InputError as e:
            raise InputError(f"{name}: {e}" if e.where is None else e.message, e.where) from None
        self.x = np.concatenate([x for x, _ in self.curves.values()])
        self.y = np.concatenate([y for _, y in self.curves.values()])
        self.observed = [(n, len(y)) for n, (_, y) in self.curves.items()]
        self.axis = "time" if self.against is None else self.against.name
        self.weight = self._weights(given.sigma)
        self.known = given.sigma is not None
        self.at = self._times(given.meet)
        problem = lower(self.model.record)
        self.exact = self._differentiates(exact, problem)
        # full Newton throughout: updates do as well, to tolerances that hide them
        self._quick = all(s.newton.full for s in problem.steps)
        needed = self.observables if self.against is None else {**self.observables, " against": self.against}
        self.kept = variables(needed, self.model.record)

    def _weights(self, sigma: Any) -> Floats:
        """(n,) one over the standard deviation, or over the greatest value of the curve."""
        sizes = [len(y) for _, y in self.curves.values()]
        if sigma is None:
            tops = [float(np.abs(y).max()) or 1.0 for _, y in self.curves.values()]
            return np.repeat(1.0 / np.array(tops), sizes)
        given = [sigma[n] for n in self.curves] if isinstance(sigma, Mapping) else sigma
        s = np.asarray(given, dtype=float)
        each = s.shape == (len(sizes),) and len(self.y) != len(s)
        s = np.repeat(s, sizes) if each else np.broadcast_to(s, self.y.shape)
        if not (s > 0).all():
            raise InputError(f"{self.name}: standard deviations must be above 0")
        return np.asarray(1.0 / s)

    def _differentiates(self, asked: bool | None, problem: LoweredProblem) -> bool:
        """Do runs bring derivatives? By themselves those of models for which they cost little beside the run."""
        from febkit.solver.sensitivity import refusal

        large = sum(len(b.ids) for b in self.model.mesh.blocks) >= LARGE
        if self.against is not None or not (large if asked is None else asked):
            return False
        return not self.options.get("accuracy") and not refusal(problem)

    def _times(self, meet: bool | None) -> list[float] | None:
        """Times that runs meet, None where they make their own."""
        times = np.unique(self.x)
        if self.against is not None or meet is False or (meet is None and len(times) > MET):
            return None
        if times[0] < 0:
            raise InputError(f"{self.name}: data before time 0 ({times[0]:g})")
        from febkit.modelling.solution import last

        end = last(self.model.record)
        if times[-1] > end * (1.0 + 1e-6):
            raise InputError(f"{self.name}: data lie at {times[0]:g} to {times[-1]:g}, the run's end at {end:g}: leave "
                             "out what it does not come to")  # fmt: skip
        fixed = any(s.control is not None and s.control.child("time_stepper") is None for s in self.model.record.steps)
        return None if fixed and meet is None else times.tolist()

    def tighten(self, much: bool = True) -> bool:
        """Solve to TIGHT from here on, so that curves follow parameters as derivatives have it; or as asked again."""
        if self._quick:  # they are so already
            return False
        asked = self._asked or 1.0
        before, self.options["tolerance"] = self.options["tolerance"] or 1.0, min(asked, TIGHT) if much else self._asked
        return bool(before != (self.options["tolerance"] or 1.0))

    def predict(self, settings: Mapping[str, float], ends: Sequence[float] | None = None, beside: bool = False) -> Made:
        if ends is None or not self._quick:  # steps of its own follow from the iterations that full Newton takes
            return self._run(settings, ends, beside, self.options)
        tolerance = min(self.options["tolerance"] or TIGHT, TIGHT)
        try:
            return self._run(settings, ends, beside, self.options | {"tolerance": tolerance, "quasi": True})
        except Failed:
            made = self._run(settings, ends, beside, self.options)
            self._quick = False  # it takes full Newton
            return made

    def _run(self, settings: Mapping[str, float], ends: Sequence[float] | None, beside: bool,
             options: Mapping[str, Any]) -> Made:  # fmt: skip
        m = self.model.copy()
        for path, value in settings.items():
            m[path] = value
        if ends is not None:
            m._put(steps=grid.on(m.record, ends).steps)
        times = grid.Times(m.record)
        sizes = {path: abs(v) or 1.0 for path, v in settings.items()} if self.exact and not beside else None
        result = m.solve(variables=self.kept, at=self.at if ends is None else None, listeners=[times],
                         warn=lambda _: None, sensitivity=sizes, **options)  # fmt: skip
        if result.interrupted:
            raise KeyboardInterrupt
        if not result.converged:
            raise Failed(f"{self.name}: {result.reason}")
        ds = result.dataset
        found = np.concatenate([self._curve(ds, o, *self.curves[n]) for n, o in self.observables.items()])
        return Made(found, times.ends, {} if sizes is None else self._derivatives(result, sizes))

    def _derivatives(self, result: Solution, paths: Iterable[str]) -> dict[str, Floats]:
        """(n,) of what the run shows at the data's x, by each path."""
        by = result.sensitivity_of(self.observables)
        each = [(by[n], x) for n, (x, _) in self.curves.items()]
        return {
            path: np.concatenate([np.interp(x, v["time"], v.sel(parameter=path)) for v, x in each]) for path in paths
        }

    def _curve(self, ds: xr.Dataset, o: Observable, x: Floats, y: Floats) -> Floats:
        """What an observable shows at the data's x."""
        try:
            found = np.asarray(o(ds).values, dtype=float)
        except InputError as e:
            raise InputError(f"{self.name}: observe {o.name!r}: {e.message}", e.where) from None
        if found.ndim == 0:  # a number of the whole run
            return np.full(len(x), float(found))
        at = np.asarray(ds["time"] if self.against is None else self.against(ds), dtype=float)
        if self.against is not None:
            order = np.argsort(at, kind="stable")
            at, found = at[order], found[order]
        slack = 1e-5 * max(abs(float(at[-1])), 1e-300)
        if x.min() < at[0] - slack or x.max() > at[-1] + slack:
            raise InputError(f"{self.name}: data of {o.name} lie at {x.min():g} to {x.max():g}, the run's at "
                             f"{at[0]:g} to {at[-1]:g}: leave out what it does not come to")  # fmt: skip
        return np.asarray(np.interp(x, at, found))


def _model(given: Any) -> Model:
    from febkit.modelling import Model
    from febkit.modelling.model import read

    if isinstance(given, (str, PathLike)):
        return read(given)
    if not isinstance(as_record(given), type(Model().record)):
        raise TypeError(f"an experiment takes a model or the path of a .feb file, not {type(given).__name__}")
    return Model.of(given).copy()
