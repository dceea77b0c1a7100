"""Nodes that stick to the facets they meet, until they are pulled off."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..kernels import contact
from . import register
from .base import Floats, Ints, Progress
from .tied_node import TiedNode, TiedSide

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class Sticky(TiedNode):
    """The traction of :class:`~.tied_node.TiedNode` holds a node from where it passes the other surface.

    A node is caught as soon as its distance from the surface is below ``snap_tol`` (at the start: below 0), and let go
    where its traction along the surface's normal exceeds ``max_traction`` (0: never). g is counted from the node moved
    by ``gap_offset`` along its normal at rest. FEBio User Manual, "Sticky".
    """

    max_traction: float = 0.0
    snap_tol: float = 0.0
    gap_offset: float = 0.0

    def begin(self, state: State, groups: list[Group]) -> None:
        self.open(state)
        s = self.sides[0].surface
        self._shift = self.gap_offset * s.nodal_normals(state.X)
        self._catch(state, np.arange(len(s.nodes)), 0.0)

    def update(self, state: State, progress: Progress) -> None:
        s = self.sides[0]
        assert isinstance(s, TiedSide)
        free = np.flatnonzero(s.partner < 0)
        s.shapes(state.x)
        s.gap = np.where((s.partner >= 0)[:, None], self._points(state) - s.place, 0.0)
        if self.max_traction > 0.0:
            pull = (self.traction(state) * self._normals(state)).sum(axis=1)
            off = (s.partner >= 0) & (pull > self.max_traction)
            s.partner[off] = -1
            s.gap[off] = s.multiplier[off] = 0.0
        self._catch(state, free, -self.snap_tol)

    def _points(self, state: State) -> Floats:
        return np.asarray(self.sides[0].positions(state.x) + self._shift)

    def _normals(self, state: State) -> Floats:
        """Normals of the partners (q, 3), 0 where there is none."""
        s, o = self.sides[0], self.sides[0].other
        assert isinstance(s, TiedSide)
        out = np.zeros((s.n, 3))
        contact.partner_normals(o.T, state.x, o.conn, o.count, s.partner, s.rs, out)
        return out

    def _catch(self, state: State, free: Ints, depth: float) -> None:
        """Give those of the points ``free`` a partner that are deeper than ``depth`` below the other surface."""
        s = self.sides[0]
        assert isinstance(s, TiedSide)
        if not len(free) or self.scale(state) == 0.0:
            return
        points = self._points(state)[free]
        s.partner[free], s.rs[free], place = s.search(state.x, points, self.search_tolerance, True)
        deep = ((place - points) * self._normals(state)[free]).sum(axis=1) > depth
        caught = free[(s.partner[free] >= 0) & deep]
        s.partner[np.setdiff1d(free, caught)] = -1
        s.shapes(state.x)
        s.gap[caught] = self._points(state)[caught] - s.place[caught]


register(Sticky, "sticky")
