"""FEBio's loop with factorisations kept over time steps: a step leans on an old one as long as that serves.

An old factorisation stands in for the tangent's inverse, with multisecant corrections; where it is slow a new one is
made within the step, and where it does not serve the step is tried once more with one of its own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .convergence import Norm, NotConverged
from .linear.krylov import matvec
from .loop import Floats, Loop
from .quasi_newton import Anderson, Update

if TYPE_CHECKING:
    from .linear.base import Matrix
    from .newton import Newton

CALM = 3  # easy steps before an old factorisation is tried: in a violent phase the answer depends on the step sizes


class Kept(Loop):
    """``leans``: old factorisations may stand in; else the step makes one of its own."""

    def __init__(self, newton: Newton, leans: bool) -> None:
        super().__init__(newton)
        self.leans, self._left = leans, np.inf  # last increment over the one allowed
        self._own: Update = self.qn
        self._anderson = Anderson(
            lambda b: newton.on_rows(newton.inverse.once, b), newton.options, fields=newton.fields
        )

    def start(self, given: Floats) -> tuple[Floats, Floats | None]:
        n = self.newton
        self._left = np.inf
        A, R0 = self._began(given)
        u = self._lean(A, R0) if self.leans and n.calm >= CALM else None
        if u is not None:
            return R0, u
        self.qn = self._own
        n.invert(A)
        self.qn.reset()
        return R0, n.on_rows(n.inverse.refined, R0)

    def _began(self, given: Floats) -> tuple[Matrix, Floats]:
        """Tangent and residual where the last steps led to, or else where the step begins, with what is prescribed."""
        n = self.newton
        ahead = n.guess(n.system.state.dt, given) if n.guess is not None and self.leans else None
        if ahead is None:
            A, Fd = n.tangent(given)
            return A, n.residual() + Fd
        self.guessed = True
        n.move(ahead)
        n.increment = ahead.copy()
        A, _ = n.tangent(np.zeros_like(given))
        R = n.residual()
        before = R.copy()  # what they would have begun with, were the system linear
        before[n.rows] += matvec(A, ahead[n.rows])
        n.convergence.scale(ahead, before)
        return A, R

    def _lean(self, A: Matrix, R0: Floats) -> Floats | None:
        """A direction by an old factorisation, None where there is none that serves."""
        n, dt = self.newton, self.newton.system.state.dt
        kept = n.inverse.near(dt)
        if kept is None:
            return None
        u, z = R0.copy(), R0.copy()
        first, z[n.rows] = n.inverse.lean_on(kept, A, dt, R0[n.rows])
        if first is None:
            return None
        self.stale, self.qn = True, self._anderson
        self.qn.reset()
        self._anderson.first(z)
        u[n.rows] = first
        return u

    def line(self, u: Floats, R0: Floats) -> tuple[float, Floats]:
        if not self.stale:
            return super().line(u, R0)
        self.newton.move(u)  # multisecant directions are no descent directions
        return 1.0, self.newton.residual()

    def update(self, s: float, u: Floats, R0: Floats, R1: Floats, reform: bool, report: dict[str, Norm]) -> None:
        if self.stale and reform:
            raise NotConverged("the factorisation of an earlier step did not serve")
        if self.stale and self._slow(report):
            self.renewed, reform, self.qn = True, True, self._own
        super().update(s, u, R0, R1, reform, report)

    def _slow(self, report: dict[str, Norm]) -> bool:
        """Would an old factorisation take more iterations than a new one is worth?

        The iterations still needed are extrapolated from the last two increments.
        """
        worth = self.newton.inverse.worth
        done, left = self.newton.count.iterations + 1, [
            np.sqrt(n.now / n.required) for k, n in report.items() if k not in ("residual", "energy") and n.required > 0
        ]  # fmt: skip
        before, self._left = self._left, max(left, default=1.0)
        if done < 2 or self._left <= 1.0:
            return done >= worth
        rate = self._left / before
        return bool(rate >= 0.9 or done + np.log(self._left) / -np.log(rate) > worth)
