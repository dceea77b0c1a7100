"""Nodes of one surface that slide on the facets of another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from . import register
from .base import Floats, Side
from .facet_on_facet import FacetOnFacet
from .penalty import automatic

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class NodeOnFacet(FacetOnFacet):
    """A pressure as :class:`~.facet_on_facet.FacetOnFacet` has it, at nodes by nodal integration.

    Half the thickness of shells counts as penetration. FEBio User Manual, "Sliding Node-on-Facet".
    """

    nodal: ClassVar[bool] = True
    written: ClassVar[float] = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._gap = 0.0

    def begin(self, state: State, groups: list[Group]) -> None:
        self._gap = 0.0
        super().begin(state, groups)

    def moduli(self, s: Side, groups: list[Group]) -> Floats:
        """Means over the facets around each node."""
        facets = automatic(s.surface, groups)
        first, star = s.surface.star
        count = np.diff(first)
        return np.asarray(np.bincount(np.repeat(np.arange(len(count)), count), facets[star], len(count)) / count)

    def offsets(self, s: Side) -> Floats | float:
        return s.surface.shell_offset

    def gap_norm(self, done: int) -> float:
        """Change of the root mean square of the penetrations since the last augmentation."""
        before, self._gap = (0.0 if done == 0 else self._gap), super().gap_norm(done)
        return abs(self._gap - before)

    def snapshot(self) -> Any:
        return super().snapshot(), self._gap

    def restore(self, saved: Any) -> None:
        sides, self._gap = saved
        super().restore(sides)


register(NodeOnFacet, "sliding-node-on-facet")
