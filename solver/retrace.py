"""A run in time steps that another one took."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .newton import Counts, Strategy
from .options import Options
from .problem import NewtonOptions, Problem, Step
from .run import Listener, Run
from .second_order import ROUNDING
from .stepping import FixedSteps

TIGHT = 1e-8  # of all increments


class Given(FixedSteps):
    """Steps to ``ends``: times, and whether each is a must point."""

    def __init__(self, step: Step, start: float, ends: Sequence[tuple[float, bool]]) -> None:
        super().__init__(step, start)
        self._ends, self._next = ends, 0
        self._take(start)

    def _take(self, t: float) -> None:
        if self._next < len(self._ends):
            end, self.at_must_point = self._ends[self._next]
            self.dt = end - t

    def accept(self, t: float, iterations: int) -> None:
        self._next += 1
        self._take(t)


class Retraced(Run):
    """``steps``: for each analysis step the steps that were taken (:class:`Given`). Solved to tight tolerances."""

    def __init__(
        self, problem: Problem, listeners: Sequence[Listener], options: Options,
        steps: Sequence[Sequence[tuple[float, bool]]],
    ) -> None:  # fmt: skip
        super().__init__(problem, listeners, options)
        self._steps = steps

    def _stepper(self) -> FixedSteps:
        taken = self._steps[self.index] if self.index < len(self._steps) else ()
        return Given(self.step, self.state.time, taken)

    def _newton_options(self) -> NewtonOptions:
        o = super()._newton_options()
        tight = {f.option: min(o.tolerance(f) or TIGHT, TIGHT) for f in self.state.layout.fields}
        return replace(o, tolerances=tight, min_residual=0.0, max_reforms=max(o.max_reforms, 60))

    def _attempt(self, how: Strategy) -> tuple[Counts, bool]:
        """A model at rest has nothing left to solve for but rounding."""
        self.newton.convergence.least = (ROUNDING * float(np.linalg.norm(self.state.reaction))) ** 2
        return super()._attempt(how)
