"""Surfaces of biphasic-solute materials that slide on each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import register
from .base import Floats, Side
from .penalty import automatic
from .sliding_multiphasic import SlidingMultiphasic

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class SlidingBiphasicSolute(SlidingMultiphasic):
    """:class:`~.sliding_multiphasic.SlidingMultiphasic` whose automatic penalty is the solid's stiffness alone.

    FEBio User Manual, "Sliding-Biphasic-Solute".
    """

    def moduli(self, s: Side, state: State, groups: list[Group]) -> Floats:
        return automatic(s.surface, groups)[s.facet]


register(SlidingBiphasicSolute, "sliding-biphasic-solute")
