"""The steps of an analysis and their control."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from febkit.feb.tree import number
from febkit.model import Component, InputError, Step

from .curves import Curve
from .node import Node
from .sets import missing
from .stage import Stage
from .text import written

if TYPE_CHECKING:
    from .model import Model

MIXTURES = ("solute", "multiphasic")  # whose matrices are unsymmetric: BFGS, FEBio's default, takes more iterations
ANALYSES = ("STATIC", "STEADY-STATE", "TRANSIENT", "DYNAMIC")


class StepView(Stage):
    """One step: its control, and what acts during it alone."""

    def __init__(self, model: Model, place: int) -> None:
        self.model, self._place = model, place

    def _step(self) -> Step:
        return self.model.record.steps[self._place]

    def _put_step(self, **changes: Any) -> None:
        steps = self.model.record.steps
        new = replace(steps[self._place], **changes)
        self.model._put(steps=(*steps[: self._place], new, *steps[self._place + 1 :]))

    @property
    def name(self) -> str | None:
        return self._step().name

    @property
    def control(self) -> Node:
        """How the step is solved: ``step.control.dtol``, ``step.control.time_stepper.dtmax``, ..."""
        if self._step().control is None:
            self._put_step(control=Component("Control"))

        def find() -> Component:
            c = self._step().control
            assert c is not None
            return c

        return Node(find, lambda new: self._put_step(control=new), "Control")

    @property
    def end(self) -> float:
        """Length of the step in time."""
        c = self.control.component
        return c.float("time_steps", 1.0) * c.float("step_size", 1.0)

    def __repr__(self) -> str:
        c = self._step().control
        said = "no control"
        if c is not None:
            said = f"{c.str('analysis', '?').lower()}, {c.str('time_steps')} steps of {c.str('step_size')}"
        held = [f"{len(getattr(self._step(), k))} {k}" for k in ("boundary", "loads", "contact", "rigid", "initial")
                if getattr(self._step(), k)]  # fmt: skip
        return f"step {self.name or self._place + 1}: {said}" + (f"; {', '.join(held)}" if held else "")


class Steps:
    """The steps of a model, by place or name."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def __len__(self) -> int:
        return len(self._model.record.steps)

    def __getitem__(self, key: int | str) -> StepView:
        held = self._model.record.steps
        if isinstance(key, str):
            names = [s.name for s in held]
            if key not in names:
                raise KeyError(missing("step", key, [n for n in names if n]))
            return StepView(self._model, names.index(key))
        return StepView(self._model, range(len(held))[key])

    def __iter__(self) -> Iterator[StepView]:
        return (StepView(self._model, k) for k in range(len(self)))

    def __delitem__(self, key: int | str) -> None:
        at, held = self[key]._place, self._model.record.steps
        self._model._put(steps=(*held[:at], *held[at + 1 :]))

    def __repr__(self) -> str:
        return "\n".join(map(repr, self)) or "no steps"


def control(
    model: Model, *, analysis: str, time: float, dt: float, dtmax: float | None = None, dtmin: float | None = None,
    must_points: Sequence[float] | None = None, retries: int | None = None, optimal: int | None = None,
    fixed: bool = False, plot: str | None = None, solver: dict[str, Any] | None = None,
) -> Component:  # fmt: skip
    """The control of a step that lasts ``time``, begun with steps of ``dt``; see :meth:`Model.step`."""
    if analysis.upper() not in ANALYSES:
        raise InputError(missing("analysis", analysis, ANALYSES))
    if not (np.isfinite([time, dt]).all() and time > 0 and 0 < dt <= time * (1 + 1e-9)):
        raise InputError(f"a step of {time:g} in steps of {dt:g}: both must be above 0, dt no longer than time")
    count = max(1, round(time / dt))
    parts = [Component("analysis", text=analysis.upper()), Component("time_steps", text=str(count)),
             Component("step_size", text=number(time / count))]  # fmt: skip
    if plot is None and must_points is not None:
        plot = "PLOT_MUST_POINTS"
    if plot is not None:
        parts.append(Component("plot_level", text=plot))
    if not fixed:
        parts.append(_stepper(model, dtmax or dt, dtmin, must_points, retries, optimal))
    module = model.record.module
    own = Node.of(Component("solver", module), f"{module} solver")
    if module in MIXTURES and "qn_method" not in (solver or {}):
        own["qn_method"] = Component("qn_method", "Broyden")
    for k, v in (solver or {}).items():
        setattr(own, k, v)
    parts.append(own.component)
    return Component("Control", children=tuple(parts))


def _stepper(
    model: Model, dtmax: float, dtmin: float | None, must: Sequence[float] | None, retries: int | None,
    optimal: int | None,
) -> Component:  # fmt: skip
    longest = Component("dtmax", text=number(dtmax))
    if must is not None:
        times = np.unique(np.concatenate([[0.0], np.asarray(must, dtype=float)]))
        lc = model.curves.add(Curve.of([(t, dtmax) for t in times], "STEP"), "must points")
        longest = Component("dtmax", text="1", attrs={"lc": str(lc)})
    given = {"max_retries": retries, "opt_iter": optimal, "dtmin": dtmin}
    parts = [Component(k, text=written(v)) for k, v in given.items() if v is not None]
    return Component("time_stepper", "default", children=(*parts, longest))
