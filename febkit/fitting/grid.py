"""The time steps of a run, and a model that takes the same: so that differences between runs are those of parameters.

An adaptive time stepper takes other steps for other parameters, and a curve then changes by the error of its time steps
too, which does not shrink with the step of a difference.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from febkit.model import Component, Model
from febkit.solver.newton import Counts
from febkit.solver.run import Listener, Run

LEFT = ("dtmax", "dtforce", "must_points")


class Times(Listener):
    """Notes the ends of time steps, where the model adapts them."""

    def __init__(self, model: Model) -> None:
        self.adapts = any(s.control is not None and s.control.child("time_stepper") is not None for s in model.steps)
        self.ends: list[float] = []

    def converged(self, run: Run, counts: Counts) -> None:
        if self.adapts:
            self.ends.append(float(run.state.time))


def on(model: Model, ends: Sequence[float]) -> Model:
    """The model with time steps that end at these times, and are cut where they fail; states of all of them are kept.

    Steps of fixed size stay.
    """
    steps = []
    for s in model.steps:
        if s.control is not None and s.control.child("time_stepper") is not None:
            parts = [_stepper(c, ends) if c.tag == "time_stepper" else c for c in s.control if c.tag != "plot_level"]
            parts.append(Component("plot_level", text="PLOT_MAJOR_ITRS"))
            s = replace(s, control=replace(s.control, children=tuple(parts)))
        steps.append(s)
    return replace(model, steps=tuple(steps))


def _stepper(stepper: Component, ends: Sequence[float]) -> Component:
    given = {"dtmax": repr(float(ends[-1])), "dtforce": "1", "must_points": ",".join(map(repr, ends))}
    left = [c for c in stepper if c.tag not in LEFT]
    return replace(stepper, children=(*left, *(Component(k, text=v) for k, v in given.items())))
