"""Transient steps of second order with an estimate of their error (opt-in; FEBio has backward Euler alone).

The rates in the equations are those of y: the relative volume J, in mixtures the moles of each solute per referential
volume too, and what is bound to the solid. The two-stage singly diagonal implicit Runge-Kutta method of Alexander
(SIAM J Numer Anal 14 (1977) 1006; L-stable, gamma = 1 - 1/sqrt 2) is then two backward Euler solves of size gamma dt:
the first from y_n to t + gamma dt, the second to t + dt from y_n + (1 - gamma) / gamma (y_1 - y_n).
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .group import Group
from .newton import Counts, Newton, Strategy
from .problem import TRANSIENT, Problem
from .solids import history
from .state import State

Floats = NDArray[np.float64]
GAMMA = 1.0 - 1.0 / sqrt(2.0)
ERROR = 2.0 * GAMMA**3 - 3.0 * GAMMA**2 + 1.0 / 6.0  # local error over dt^3 y''' (linear problems)
ROUNDING = 1e-13  # of a residual, over the forces at the nodes
ENOUGH = 1e-3  # accuracy down to which FEBio's min_residual leaves less than the error of the steps
LEVEL = 0.01  # of what mixtures start from counts as a change to which errors are relative


def refusal(problem: Problem) -> str:
    """Why steps of second order make no sense for a problem; empty where they do."""
    if not problem.diffuses or any(s.analysis != TRANSIENT for s in problem.steps):
        return "steps of second order are for transient analyses of biphasic models and of those with solutes"
    if any(s.adaptors for s in [problem.common, *problem.steps]):
        return "steps of second order do not follow meshes that change"
    if any(s.explicit for s in problem.steps):
        return "steps of second order are for implicit analyses"
    if problem.bodies:
        return "rigid bodies turn by steps of first order"
    if any(s.contacts for s in [problem.common, *problem.steps]):
        return "steps of second order do not follow surfaces in contact"
    for b in problem.blocks:
        if history.initial(b.solid, 1).shape[1]:
            return f"the material of part {b.name!r} has a memory, which is kept to first order only"
    return ""


class SecondOrder:
    """One step at a time: :meth:`solve` moves the state and gives the relative error it estimates."""

    def __init__(self, state: State, groups: list[Group], newton: Newton, accuracy: float) -> None:
        self.state, self.newton, self.accuracy = state, newton, accuracy
        self._most = newton.options.min_residual
        newton.guess = None  # what the unknowns grow by in a stage is not what they grow by in a step
        self.groups = groups
        self._past: list[tuple[float, list[Floats]]] = []  # times and values at the ends of the last steps
        for g in groups:
            g.physics.stages()
        start = self._values()
        self._rest = start if state.layout.concentrations.size else [np.zeros_like(y) for y in start]
        self._scale = np.zeros(len(state.layout.fields) + len(start) - 1)

    def _values(self) -> list[Floats]:
        """What has an error: the nodal array, and what else has rates of its own."""
        return [self.state.d.copy(), *(y.copy() for g in self.groups for y in g.physics.hidden())]

    def _norms(self, y: list[Floats]) -> Floats:
        """Norms of the fields, and of what is hidden."""
        return np.array([*self.state.layout.norms(y[0]), *(np.linalg.norm(q) for q in y[1:])])

    def _size(self, y: list[Floats]) -> Floats:
        """What errors are relative to: the fields' norms, in mixtures those of their changes.

        Effective pressures of mixtures start far from zero, from where their changes are small; LEVEL of what a field
        starts from keeps one that hardly changes from being resolved for its own sake.
        """
        changed = self._norms([a - b for a, b in zip(y, self._rest, strict=True)])
        return np.maximum(changed, LEVEL * self._norms(self._rest))

    def snapshot(self) -> Any:
        return [(t, list(y)) for t, y in self._past], list(self._rest), self._scale.copy()

    def restore(self, saved: Any) -> None:
        self._past, self._rest, self._scale = [(t, y) for t, y in saved[0]], saved[1], saved[2]

    def begin(self) -> None:
        """Remember the state that steps start from."""
        self._past = [*self._past[-2:], (self.state.time, self._values())]

    def solve(self, dt: float, prepare: Callable[[], None], how: Strategy | None = None) -> tuple[Counts, float]:
        """Step by ``dt``, both stages by Newton's strategy ``how``; ``prepare`` makes the present state the last
        converged one.

        Returns the iterations of both stages and the estimated local error of the fields, relative to the largest met.
        """
        s, start = self.state, self.state.time
        self.newton.convergence.least = self._least()
        s.dt = GAMMA * dt
        s.time = start + s.dt
        prepare()
        d0 = s.d_old
        counts = self.newton.step(how)
        first = self._values()
        for g in self.groups:  # the second stage starts from a point beyond the first
            for before, now in g.physics.rates():
                before += (1.0 - GAMMA) / GAMMA * (now - before)
        s.time = start + dt
        second = self.newton.step(how)
        counts.iterations = max(counts.iterations, second.iterations)
        counts.residuals += second.residuals
        counts.factorisations += second.factorisations
        s.velocity = (s.u - s.displacements(d0)) / dt
        return counts, self._error(start, dt, first)

    def _least(self) -> float:
        """The squared residual that counts as none: FEBio's, smaller by (accuracy / ENOUGH)^2, but not below rounding.

        FEBio's, in units of the model, leaves so much of the fluid's balance in small models that it adds up over
        steps to more than their error.
        """
        rounding = ROUNDING * float(np.linalg.norm(self.state.reaction))
        return min(self._most, max(self._most * (self.accuracy / ENOUGH) ** 2, rounding**2))

    def _error(self, start: float, dt: float, first: list[Floats]) -> float:
        """The smaller of two estimates: by the third difference of the last steps, where there are as many and the
        loads are smooth, and by what the second stage adds to the first's line, which is of the step alone."""
        now, d0 = self._values(), self._past[-1][1]
        estimates = [[0.2 * (y - y0 - (y1 - y0) / GAMMA) for y, y0, y1 in zip(now, d0, first, strict=True)]]
        if len(self._past) == 3:
            t = np.array([q for q, _ in self._past])
            weight = [np.prod([(start + dt - t[j]) / (t[i] - t[j]) for j in range(3) if j != i]) for i in range(3)]
            ahead = (sum(w * y[k] for w, (_, y) in zip(weight, self._past)) for k in range(len(now)))
            third = [(y - a) / np.prod(start + dt - t) for y, a in zip(now, ahead)]  # y''' / 6
            estimates.append([6.0 * ERROR * dt**3 * y for y in third])
        if not self._scale.any():  # the first step sets the scale: its size is the file's
            self._scale = self._size(now)
            return 0.0
        self._scale = np.maximum(self._scale, self._size(now))
        scale = np.where(self._scale > 0.0, self._scale, 1.0)
        return float(min((self._norms(e) / scale).max() for e in estimates))
