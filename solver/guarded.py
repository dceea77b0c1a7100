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

from .group import ElementFailure

if TYPE_CHECKING:
    from .newton import Newton

Floats = NDArray[np.float64]
KEPT = 0.2  # of its volume that a point keeps in an iteration
LEAST = 1.0 / 256  # of Newton's direction that is worth taking
MOST = 60  # iterations


def solve(newton: Newton) -> None:
    """Solve the present time step. Raises NotConverged, NotFinite and LinearError."""
    from .newton import Norms, NotConverged

    system, norms, done = newton.system, Norms(), 0.0
    before, after = system.state.d.copy(), newton.targets()
    newton.target, newton.increment = after, np.zeros_like(newton.total)
    given = np.zeros_like(newton.total)
    given[newton.given] = (system.gather(after) - system.gather(before))[newton.given]
    system.progress.iterations = system.progress.augmentations = 0
    system.update()
    newton.qn.reset()
    newton.qn.begin()
    newton.force_reform = False
    R = newton.residual()
    for _ in range(MOST):
        A, Fd = newton.tangent((1.0 - done) * given)
        newton.invert(A)
        R0 = R + Fd
        u = newton.on_rows(newton.inverse.refined, R0)
        if not np.isfinite(u).all():
            raise NotConverged("the solution of the linear system is not finite (singular tangent?)")
        s = _guard(newton, u, before + done * (after - before), (1.0 - done) * (after - before))
        done = 1.0 if s == 1.0 else done + s * (1.0 - done)
        R = newton.residual()
        _, converged = newton.judge(u, s, R0, R, norms)
        newton.count.iterations += 1
        system.progress.iterations = newton.count.iterations
        if converged and done == 1.0:
            if not newton.augments or newton.augment():
                return
            R = newton.residual()
    raise NotConverged(f"{MOST} guarded Newton steps did not converge")


def _guard(newton: Newton, u: Floats, target: Floats, ahead: Floats) -> float:
    """Go along u, and from ``target`` along ``ahead`` where prescribed, as far as all points keep enough of their
    volume; the part that was gone."""
    from .newton import NotConverged

    system, s = newton.system, 1.0
    J = [g.J.copy() for g in system.groups]
    why = "no part of Newton's direction leaves the elements as they should be"
    while s >= LEAST:
        try:
            with newton.clock("stress update"):
                system.set(newton.total, newton.increment, s * u, target + s * ahead)
            if all((KEPT * old <= g.J).all() for g, old in zip(system.groups, J)):
                return s
        except ElementFailure as e:
            why = str(e)
        s *= 0.5
    raise NotConverged(why)
