"""Integration points of one surface tied to the closest points of another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from . import register
from .tied_node import TiedNode, TiedSide

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class TiedFacet(TiedNode):
    """As :class:`~.tied_node.TiedNode`, at integration points. FEBio User Manual, "Tied Facet-on-Facet".

    ``gap_offset``: the gap at the start is kept.
    """

    gap_offset: bool = False
    nodal: ClassVar[bool] = False

    def begin(self, state: State, groups: list[Group]) -> None:
        super().begin(state, groups)
        s = self.sides[0]
        assert isinstance(s, TiedSide)
        if self.gap_offset:
            s.start, s.gap = s.gap, 0.0 * s.gap


register(TiedFacet, "tied-facet-on-facet")
