"""Transient biphasic steps of second order with an estimate of their error (opt-in; FEBio has backward Euler alone).

The only rate in the equations is that of the relative volume J, so the two-stage singly diagonal implicit Runge-Kutta
method of Alexander (SIAM J Numer Anal 14 (1977) 1006; L-stable, gamma = 1 - 1/sqrt 2) is two backward Euler solves of
size gamma dt: the first from J_n to t + gamma dt, the second to t + dt from J_n + (1 - gamma) / gamma (J_1 - J_n).
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

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


def refusal(problem: Problem) -> str:
    """Why steps of second order make no sense for a problem; empty where they do."""
    if not problem.diffuses or any(s.analysis != TRANSIENT for s in problem.steps):
        return "steps of second order are for transient analyses of biphasic models"
    if problem.bodies:
        return "rigid bodies turn by steps of first order"
    if any(s.contacts for s in [problem.common, *problem.steps]):
        return "steps of second order do not follow surfaces in contact"
    if any(b.physics.name == "multiphasic" for b in problem.blocks):
        return "steps of second order do not follow solutes"
    for b in problem.blocks:
        if history.initial(b.solid, 1).shape[1]:
            return f"the material of part {b.name!r} has a memory, which is kept to first order only"
    return ""


class SecondOrder:
    """One step at a time: :meth:`solve` moves the state and gives the relative error it estimates."""

    def __init__(self, state: State, groups: list[Group], newton: Newton, accuracy: float) -> None:
        self.state, self.newton, self.accuracy = state, newton, accuracy
        self._most = newton.options.min_residual
        self.groups = groups
        self._past: list[tuple[float, Floats]] = []  # times and values at the ends of the last steps
        self._scale = np.zeros(len(state.layout.fields))

    def begin(self) -> None:
        """Remember the state that steps start from."""
        self._past = [*self._past[-2:], (self.state.time, self.state.d.copy())]

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
        first = s.d.copy()
        for g in self.groups:  # the second stage starts from a point beyond the first
            for before, now in g.physics.rates():
                before += (1.0 - GAMMA) / GAMMA * (now - before)
        s.time = start + dt
        second = self.newton.step(how)
        counts.iterations = max(counts.iterations, second.iterations)
        counts.residuals += second.residuals
        counts.factorisations += second.factorisations
        s.velocity = (s.u - s.displacements(d0)) / dt
        return counts, self._error(start, dt, d0, first)

    def _least(self) -> float:
        """The squared residual that counts as none: FEBio's, smaller by (accuracy / ENOUGH)^2, but not below rounding.

        FEBio's, in units of the model, leaves so much of the fluid's balance in small models that it adds up over
        steps to more than their error.
        """
        rounding = ROUNDING * float(np.linalg.norm(self.state.reaction))
        return min(self._most, max(self._most * (self.accuracy / ENOUGH) ** 2, rounding**2))

    def _error(self, start: float, dt: float, d0: Floats, first: Floats) -> float:
        """The smaller of two estimates: by the third difference of the last steps, where there are as many and the
        loads are smooth, and by what the second stage adds to the first's line, which is of the step alone."""
        now, norms = self.state.d, self.state.layout.norms
        inner = 0.2 * (now - d0 - (first - d0) / GAMMA)
        estimates = [inner]
        if len(self._past) == 3:
            t = np.array([q for q, _ in self._past])
            weight = [np.prod([(start + dt - t[j]) / (t[i] - t[j]) for j in range(3) if j != i]) for i in range(3)]
            ahead = sum(w * y for w, (_, y) in zip(weight, self._past))
            third = (now - ahead) / np.prod(start + dt - t)  # y''' / 6
            estimates.append(6.0 * ERROR * dt**3 * third)
        if not self._scale.any():  # the first step sets the scale: its size is the file's
            self._scale = norms(now)
            return 0.0
        self._scale = np.maximum(self._scale, norms(now))
        scale = np.where(self._scale > 0.0, self._scale, 1.0)
        return float(min((norms(e) / scale).max() for e in estimates))
