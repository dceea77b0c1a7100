"""A time step solved by guarded Newton steps, where FEBio's loop and its retries have come to their end.

Prescribed values go to their targets together with the free unknowns: an iteration takes as much of Newton's direction
as leaves every integration point a fifth of its volume (the fraction-to-the-boundary rule of interior point methods:
Nocedal and Wright, Numerical Optimization (2006), section 19.2), with a new tangent each time. So a layer of elements
thinner than its face's displacement in the step moves with the face instead of being pushed through.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .convergence import NotConverged
from .group import ElementFailure

if TYPE_CHECKING:
    from .newton import Newton

Floats = NDArray[np.float64]
KEPT = 0.2  # of its volume that a point keeps in an iteration
LEAST = 1.0 / 256  # of Newton's direction that is worth taking
MOST = 60  # iterations


class Guarded:
    """See above."""

    def __init__(self, newton: Newton) -> None:
        self.newton = newton
        self.stale = self.renewed = self.guessed = False

    def solve(self) -> None:
        """Solve the present time step. Raises NotConverged, NotFinite and LinearError."""
        n, done = self.newton, 0.0
        before = n.system.state.d.copy()
        given, after = n.begin(), n.target
        R = n.residual()
        for _ in range(MOST):
            A, Fd = n.tangent((1.0 - done) * given)
            n.invert(A, limited=False)
            R0 = R + Fd
            u = n.on_rows(n.inverse.refined, R0)
            if not np.isfinite(u).all():
                raise NotConverged("the solution of the linear system is not finite (singular tangent?)")
            s = self._go(u, before + done * (after - before), (1.0 - done) * (after - before))
            done = 1.0 if s == 1.0 else done + s * (1.0 - done)
            R = n.residual()
            _, converged = n.judge(u, s, R0, R, 0)
            n.count.iterations += 1
            n.system.progress.iterations = n.count.iterations
            if converged and done == 1.0:
                if not n.augments or n.augment():
                    return
                R = n.residual()
        raise NotConverged(f"{MOST} guarded Newton steps did not converge")

    def _go(self, u: Floats, target: Floats, ahead: Floats) -> float:
        """Go along u, and from ``target`` along ``ahead`` where prescribed, as far as all points keep enough of their
        volume; the part that was gone."""
        system, s = self.newton.system, 1.0
        J = [g.J.copy() for g in system.groups]
        why = "no part of Newton's direction leaves the elements as they should be"
        while s >= LEAST:
            try:
                self.newton.move(s * u, target + s * ahead)
                if all((KEPT * old <= g.J).all() for g, old in zip(system.groups, J)):
                    return s
            except ElementFailure as e:
                why = str(e)
            s *= 0.5
        raise NotConverged(why)
