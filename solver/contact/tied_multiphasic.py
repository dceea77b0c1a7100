"""Facets of mixtures tied to others: displacement, fluid pressure and the concentrations of common solutes pass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import register
from .base import Floats, Side
from .passage import solutes
from .penalty import mixture
from .tied_biphasic import TiedBiphasic

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class TiedMultiphasic(TiedBiphasic):
    """As :class:`~.tied_biphasic.TiedBiphasic`, with flows L + eps_c (c1 - c2) of solutes that both facets hold, too.

    FEBio User Manual, "Tied Multiphasic".
    """

    concentration_penalty: float = 1.0
    ctol: float = 0.0
    RT: float = 1.0

    def carried(self, groups: list[Group]) -> list[tuple[str, float]]:
        return [*super().carried(groups), *((f, self.concentration_penalty) for f in solutes(groups))]

    def moduli(self, s: Side, state: State, groups: list[Group]) -> Floats:
        return mixture(s.surface, groups, state)[s.facet]


register(TiedMultiphasic, "tied-multiphasic")
