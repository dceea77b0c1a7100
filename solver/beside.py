"""What residuals of variations of a run differ by from its own: of elements, in one pass over these for all variations.

Variations differ from the run by so little that forces differ by their derivatives along what nodal values, laws and
histories differ by. What these take of the run (geometry, stresses, tangents of laws) is made once for all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .changes import Changes
from .group import Group
from .kernels import variations
from .kernels.vectors import put_times
from .schedule import Share

if TYPE_CHECKING:
    from .run import Run
    from .variation import Variation

Floats = NDArray[np.float64]


class Beside:
    """Passes over the elements of a run in its present analysis step. Raises what laws of variations raise."""

    def __init__(self, base: Run) -> None:
        assert base.system is not None
        self.base, self.system = base, base.system

    def serves(self, v: Variation) -> bool:
        """May residuals of a variation be had so?"""
        own, newton = self.system, self.base.newton
        if own.contacts or own.body_loads or own.following or newton.augments or newton.options.logarithmic:
            return False
        if own.ties is not None or own.rotations is not None or own.alphaf != 1.0:
            return False
        return all(
            type(g) is Group and g.physics.varies and g.iJ0 is b.iJ0 and len(g.chunks) == len(b.chunks)
            for g, b in zip(v.groups, self.base.groups)
        )

    # ---- residuals --------------------------------------------------------------------------------
    def first(self, some: Sequence[Variation]) -> list[Floats]:
        """By how much residuals (row,) of variations differ from the run's, at their present nodal values."""
        base = self.base
        D = self._apart(some)
        R = self._pass(D, [self._changes(k, some, D) for k in range(len(base.groups))])
        for v, inner in zip(some, R):
            v.inner = inner.copy() if self.loaded else inner
        if self.loaded:
            external = np.zeros_like(base.state.d)
            self.system.add_external(external)
            for v, total in zip(some, R):
                own = np.zeros_like(external)
                assert v.system is not None
                v.system.add_external(own)
                total += own - external
        return [self._over(r) for r in R]

    def next(self, some: Sequence[Variation]) -> list[Floats]:
        """The same, and what variations' last corrections add, where nothing acts beside the elements."""
        self.correct(some)
        return [self._over(v.inner) for v in some]

    def correct(self, some: Sequence[Variation]) -> None:
        """Add to ``inner`` of variations what their last corrections do."""
        D = np.zeros((len(some), *self.base.state.d.shape))
        for v, d in zip(some, D):
            put_times(self.system.eqs.free_places, v.delta, v.u, d.reshape(-1))
        none = np.full(len(some), -1, np.int64)
        own = [Changes(self._own(g, D), [], none, np.zeros((len(some), g.m, g.g))) for g in self.base.groups]
        for v, more in zip(some, self._pass(D, own)):
            v.inner = v.inner + more

    def reactions(self, some: Sequence[Variation]) -> None:
        """Bring reactions of variations up to date, whose last corrections the residuals have not seen."""
        self.correct(some)
        for v in some:
            v.reacted = True
            v.alight()
            if v.state.layout.moves:
                v.state.reaction = self.base.state.reaction - v.state.layout.u(v.inner)

    def _apart(self, some: Sequence[Variation]) -> Floats:
        """By how much nodal values (v, node, column) differ."""
        return np.array([v.D if v.rides else v.state.d - self.base.state.d for v in some])

    @property
    def loaded(self) -> bool:
        """Are there forces beside those of the elements?"""
        return bool(self.system.loads) or self.system.dynamic

    def _pass(self, D: Floats, changes: list[Changes]) -> Floats:
        """What forces of all elements (v, node, column) change by."""
        base, system = self.base, self.system
        number = {id(g): k for k, g in enumerate(base.groups)}
        parts = [[np.zeros_like(c.D) for c in changes] for _ in range(system.schedule.n)]

        def work(share: Share) -> None:
            for g, c in share.chunks:
                k = number[id(g)]
                rest = parts[share.thread][k], system._work[share.thread], system.steady
                g.physics.vary(c, base.state, changes[k], *rest)

        system.schedule.map(work)
        R = np.zeros_like(D)
        for part in parts:
            for g, own in zip(base.groups, part):
                R[:, :, g.columns] += own
        return R

    def _changes(self, k: int, some: Sequence[Variation], D: Floats) -> Changes:
        """Those in group k."""
        g = self.base.groups[k]
        others = [(v.groups[k].physics, *v.differs[k]) for v in some if any(v.differs[k])]
        other = np.array([any(v.differs[k]) for v in some])
        which = np.where(other, np.cumsum(other) - 1, -1)
        return Changes(self._own(g, D), others, which, np.array([v.swelled[k] for v in some]))

    @staticmethod
    def _own(g: Group, D: Floats) -> Floats:
        """The group's columns of nodal values (v, node, column)."""
        return D if np.array_equal(g.columns, np.arange(D.shape[2])) else np.ascontiguousarray(D[:, :, g.columns])

    def _over(self, total: Floats) -> Floats:
        """Nodal forces over the free unknowns."""
        return self.system.gather(total).take(self.base.newton.rows)

    # ---- the step's end ---------------------------------------------------------------------------
    def volumes(self, some: Sequence[Variation]) -> None:
        """Tell variations by how much relative volumes (m, g) of theirs differ from the run's, where these matter."""
        D = self._apart(some)
        for k, g in enumerate(self.base.groups):
            dJ = np.zeros((len(some), g.m, g.g))
            if g.physics.rates() and not self.system.steady:
                own = self._own(g, D)

                def work(share: Share, g: Group = g, own: Floats = own, dJ: Floats = dJ) -> None:
                    for lo, hi in ((lo, hi) for h, lo, hi in share.spans if h is g):
                        variations.volumes(g.n, g.g)(lo, hi, g.conn, g.dN, g.iJ0, g.F, g.J, own, dJ)

                self.system.schedule.map(work)
            for v, mine in zip(some, dJ):
                v.swells[k] = mine
