"""What :meth:`febkit.Model.solve` gives back: the result in words, and its fields as a dataset in memory."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.model import Component, InputError, Output, PlotVariable
from febkit.model import Model as Record

if TYPE_CHECKING:
    import xarray as xr

    from febkit.observe import Observe
    from febkit.solver.result import Result, Totals
    from febkit.solver.state import State

    from .again import Again
    from .model import Model
    from .sensitivity import Given, Sensitivity


class Solution:
    """The end of a run.

    converged, reason: whether it came to its end, and why not, in a sentence; times: those of the states in
    :attr:`dataset`; state: the nodal fields at the end (u, p, reaction, ...); totals: steps, iterations, seconds.
    """

    def __init__(
        self, result: Result, datasets: Sequence[xr.Dataset], sensitivity: Sensitivity | None = None,
    ) -> None:  # fmt: skip
        self.result, self._datasets, self._asked = result, list(datasets), sensitivity
        self._sensitivity: xr.Dataset | None = None

    @property
    def converged(self) -> bool:
        return self.result.converged

    @property
    def reason(self) -> str:
        return self.result.reason

    @property
    def state(self) -> State:
        return self.result.state

    @property
    def totals(self) -> Totals:
        return self.result.totals

    @property
    def times(self) -> list[float]:
        return self.result.times

    @property
    def interrupted(self) -> bool:
        return self.result.interrupted

    @property
    def dataset(self) -> xr.Dataset:
        """The same xarray.Dataset as from a plotfile of the run. Raises InputError where adaptors changed the mesh."""
        if not self._datasets:
            raise InputError("nothing was kept of this run: no state was solved")
        if len(self._datasets) > 1:
            raise InputError("the mesh changed during the run: take .datasets, one for each mesh")
        return self._datasets[0]

    @property
    def datasets(self) -> list[xr.Dataset]:
        """One dataset for each mesh of the run, in order of time: several where adaptors refined it."""
        return self._datasets

    @property
    def sensitivity(self) -> xr.Dataset:
        """Derivatives of the dataset's variables by the parameters that were asked for (parameter, ...).

        ``method`` says for each parameter whether they are "direct", from the equations of each step, or by
        "differences" of whole runs, and ``attrs["why"]`` why.
        """
        if self._asked is None:
            raise InputError('no derivatives were asked for: solve(sensitivity=["cartilage.solid.E"])')
        if self._sensitivity is None:
            self._sensitivity = self._asked.dataset(self.dataset)
        return self._sensitivity

    def sensitivity_of(self, observe: Observe) -> xr.Dataset:
        """Derivatives (parameter, time) of observables, in words or functions of a dataset (:mod:`febkit.observe`)."""
        from .sensitivity import of_observables

        return of_observables(observe, self.dataset, self.sensitivity)

    def __bool__(self) -> bool:
        return self.converged

    def __repr__(self) -> str:
        t = self.totals
        end = "solved" if self.converged else f"stopped: {self.reason};"
        return (f"{end} to t = {self.state.time:g}: {t.steps} steps, {t.iterations} iterations, {t.retries} retries, "
                f"{t.seconds.get('total', 0.0):.2f} s")  # fmt: skip


def solve(
    model: Record, plotfile: Any = None, again: Again | None = None, of: Callable[[Record], Model] | None = None, *,
    variables: Sequence[str] | None = None, at: Sequence[float] | None = None, sensitivity: Given | None = None,
    sensitivity_tolerance: float = 1e-3, **options: Any,
) -> Solution:  # fmt: skip
    """Solve a model and keep its fields.

    Without ``plotfile`` they stay in memory (single precision, as a plotfile holds them) and no file is written; with
    one the dataset reads it when touched. ``variables``: plot variables instead of the model's; ``at``: times that are
    met and kept, instead of the states that the model asks for; ``again``: what an earlier run left; ``sensitivity``:
    paths of parameters by which results are differentiated, to ``sensitivity_tolerance`` in each step; ``of``: what
    makes of records models that can be edited. Other options are those of :func:`febkit.solve`.
    """
    from febkit.results import open_all
    from febkit.solving import solve as run

    if variables is not None:
        from .output import known

        plot = tuple(PlotVariable(known(v)) for v in variables)
        model = replace(model, output=replace(model.output or Output(), plot=plot))
    if at is not None:
        model = kept_at(model, at)
    asked = None
    if sensitivity is not None and of is not None:
        from .sensitivity import Sensitivity

        asked = Sensitivity(of(model), sensitivity, sensitivity_tolerance, options)
        options["listeners"] = [*asked.listeners, *options.get("listeners", ())]
    if again is not None:
        options["graph"] = again.graphs
    if plotfile is not None:
        result = run(model, plotfile, **options)
        every = open_all(plotfile) if Path(plotfile).is_file() else []
        return Solution(result, [picked(ds, at) for ds in every], asked)
    from febkit.files import Buffer
    from febkit.results import held_all

    buffer = Buffer()
    result = run(model, buffer, **options)
    every = held_all(buffer.data) if buffer.data else []
    return Solution(result, [picked(ds, at).load() for ds in every], asked)


def picked(ds: xr.Dataset, at: Sequence[float] | None) -> xr.Dataset:
    """The states at times ``at``, those that the run came to; all where none are named."""
    if at is None:
        return ds
    t, wanted = np.asarray(ds["time"].values, dtype=float), np.unique(np.asarray(at, dtype=float))
    near = np.abs(t[:, None] - wanted).min(axis=1) <= 1e-6 * max(float(wanted[-1]), 1e-300)
    return ds.isel(time=np.flatnonzero(near))


def last(model: Record) -> float:
    """The time at which a model's steps end (inf where one has no control)."""

    def length(c: Component) -> float:
        n = c.int("time_steps", 10)
        return c.float("final_time", 0.0) if n == -1 else n * c.float("step_size", 0.1)

    return sum((math.inf if s.control is None else length(s.control) for s in model.steps), 0.0)


def kept_at(model: Record, times: Sequence[float]) -> Record:
    """The model with must points at ``times`` in all its steps, and states kept at must points alone."""
    from febkit.coupling.boundary import with_must_points

    t = np.unique(np.asarray(times, dtype=float))
    if not len(t) or not np.isfinite(t).all() or t[0] < 0:
        raise InputError("at= takes times from 0 on")
    end = last(model)
    if t[-1] > end * (1.0 + 1e-6):
        raise InputError(f"the time {t[-1]:g} is asked for, and the model's steps end at {end:g}")
    changed, said = with_must_points(model, t)
    if any("fixed size" in line for line in said):
        raise InputError("a step of fixed size meets no times of its own: give its control a time stepper")
    steps = []
    for s in changed.steps:
        if s.control is not None:
            left = tuple(c for c in s.control.children if c.tag != "plot_level")
            level = replace(s.control, tag="plot_level", type=None, text="PLOT_MUST_POINTS", children=(), attrs={})
            s = replace(s, control=replace(s.control, children=(*left, level)))
        steps.append(s)
    return replace(changed, steps=tuple(steps))
