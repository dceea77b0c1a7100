"""FEBio's way of solving a time step: the tangent of its start, quasi-Newton updates of the inverse, a line search."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .convergence import Norm, NotConverged
from .finite import whole
from .line_search import search
from .quasi_newton import METHODS, FullNewton, Update

if TYPE_CHECKING:
    from .newton import Newton

Floats = NDArray[np.float64]


class Loop:
    """``qn`` has the updates, which are made as the options of the analysis step say."""

    def __init__(self, newton: Newton) -> None:
        self.newton = newton
        method = FullNewton if newton.full else METHODS[newton.options.method]
        self.qn: Update = method(lambda b: newton.on_rows(newton.inverse.solve, b), newton.options)
        self.stale = self.renewed = self.guessed = False

    def solve(self) -> None:
        """Solve the present time step. Raises NotConverged, NotFinite, ElementFailure or LinearError."""
        n = self.newton
        self.stale = self.renewed = self.guessed = False
        given = n.begin()
        self.qn.begin()
        R0, u = self.start(given)
        while True:
            after = self._iterate(R0, u)
            if after is None:
                return
            R0, u = after, None
            n.system.progress.iterations = n.count.iterations

    def start(self, given: Floats) -> tuple[Floats, Floats | None]:
        """Residual with prescribed increments at the start of a step, and a direction where one is found."""
        Fd = self.reform(given)
        return self.newton.residual() + Fd, None

    def reform(self, step: Floats) -> Floats:
        """Renew the tangent and its inverse; returns minus its prescribed columns times ``step``."""
        A, Fd = self.newton.tangent(step)
        self.newton.invert(A)
        self.qn.reset()
        self.stale = False
        return Fd

    def direction(self, R0: Floats) -> Floats:
        """Where the residual R0 leads to."""
        return self.qn.solve(R0)

    def line(self, u: Floats, R0: Floats) -> tuple[float, Floats]:
        """How far to go along u, and the residual there."""
        n = self.newton
        return search(u, R0, n.move, n.residual, n.options)

    def _iterate(self, R0: Floats, u: Floats | None) -> Floats | None:
        """One iteration: the residual after it, None where the step is solved."""
        n, o, k = self.newton, self.newton.options, self.newton.count
        if u is None:
            u = self.direction(R0)
        if not whole(u):
            raise NotConverged("the solution of the linear system is not finite (singular tangent?)")
        s, R1 = self.line(u, R0)
        report, converged = n.judge(u, s, R0, R1, self.qn.count)
        r1 = report["residual"].now
        if not converged and 0 < o.max_residual <= r1:
            raise NotConverged(f"the residual {r1:g} is above max_residual = {o.max_residual:g}")
        if converged:
            after = None if not n.augments or n.augment() else self._augmented()
        else:
            small = o.line_tolerance > 0 and s < o.line_minimum
            self.update(s, u, R0, R1, small or n.convergence.diverged(report), report)
            after = R1
        k.iterations += 1
        return after

    def _augmented(self) -> Floats:
        """The residual with new multipliers."""
        n = self.newton
        R = n.residual()
        self.qn.begin()
        if n.options.updates == 0 or n.options.reform_augment:
            self.reform(np.zeros_like(n.total))
        return R

    def update(self, s: float, u: Floats, R0: Floats, R1: Floats, reform: bool, report: dict[str, Norm]) -> None:
        """Learn from the step s u, or renew the tangent."""
        if reform or not self.qn.update(s, u, R0, R1):
            self.reform(np.zeros_like(u))
