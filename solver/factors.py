"""Factorisations kept over time steps, and which of them may serve a step.

An old factorisation M of a tangent K' close to the present K gives the direction K^-1 R by a few iterations of GMRES
and later ones by multisecant corrections. Steps alternate between long ones and short ones before must points, so two
are kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .linear.base import LinearSolver

KEEP = 2
REUSE_RATIO = 4.0  # an old factorisation is tried for a step size within this factor of its own
RETRY_RATIO = 1.3  # the same for a step that is tried again with a smaller dt
LEAST, MOST = 5, 12  # bounds of the iterations given to an old factorisation before a new one is made


@dataclass(slots=True)
class Factor:
    """A factorisation, the step size it was made for, and the start (time) of the step if it was made there."""

    dt: float
    solver: LinearSolver
    start: float = np.nan
    used: int = 0


class Factors:
    """At most KEEP factorisations; ``solver`` is the one in use."""

    def __init__(self, make: Callable[[], LinearSolver]) -> None:
        self._make = make
        self.solver = make()
        self._kept: list[Factor] = []
        self._uses = 0

    def near(self, dt: float) -> Factor | None:
        """The factorisation whose step size is nearest to ``dt``, where it may serve."""
        return _nearest(self._kept, dt, REUSE_RATIO)

    def of_start(self, start: float, dt: float) -> Factor | None:
        """A factorisation of the very state at time ``start``, for a step that is tried again.

        Only where factorisations are dear: the corrections that follow are of another step size.
        """
        if self.worth < MOST:
            return None
        return _nearest([f for f in self._kept if abs(f.start - start) <= 1e-12 * abs(start)], dt, RETRY_RATIO)

    def take(self, f: Factor) -> None:
        self._uses += 1
        self.solver, f.used = f.solver, self._uses

    def renew(self, dt: float, start: float) -> None:
        """Make room for a factorisation: in place of one that could have served it, or of the longest unused."""
        f = self.near(dt)
        if f is None and len(self._kept) < KEEP:
            f = Factor(dt, self._make() if self._kept else self.solver)
            self._kept.append(f)
        elif f is None:
            f = min(self._kept, key=lambda f: f.used)
        f.dt, f.start = dt, start
        self.take(f)

    @property
    def worth(self) -> float:
        """Iterations that take as long as a factorisation.

        It is about 3 nnz(L)^2 / n operations against the 4 nnz(L) of a solve, the latter sixteen times slower for
        being bound by memory; residual and stresses take as much again.
        """
        stats = self.solver.stats
        ratio = stats.get("factor_entries", 0.0) / max(stats.get("equations", 1.0), 1.0) / 64.0
        return float(np.clip(ratio, LEAST, MOST))

    def close(self) -> None:
        """Free all."""
        for solver in [self.solver, *[f.solver for f in self._kept]]:
            solver.close()


def _nearest(factors: list[Factor], dt: float, most: float) -> Factor | None:
    ratios = [(max(dt / f.dt, f.dt / dt), k) for k, f in enumerate(factors)]
    best = min(ratios, default=(np.inf, -1))
    return factors[best[1]] if best[0] <= most else None
