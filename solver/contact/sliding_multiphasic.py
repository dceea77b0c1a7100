"""Surfaces of mixtures that slide on each other: fluid and solutes pass where they touch; a bath holds the rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..fields import PRESSURE
from ..values import as_value
from . import register
from .base import Floats, Side
from .passage import solutes
from .penalty import mixture
from .sliding_biphasic import SlidingBiphasic

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class SlidingMultiphasic(SlidingBiphasic):
    """As :class:`~.sliding_biphasic.SlidingBiphasic`, with flows L + eps_c (c1 - c2) of common solutes, too.

    Nodes that touch nothing have the effective pressure ``ambient_pressure`` and the effective concentrations
    ``ambient_concentration`` (field -> Value, 0 where none is given). FEBio User Manual, "Sliding-Multiphasic".
    """

    concentration_penalty: float = 1.0
    ctol: float = 0.0
    RT: float = 1.0
    ambient_pressure: Any = 0.0  # a Value
    ambient_concentration: Mapping[str, Any] = field(default_factory=dict)

    def begin(self, state: State, groups: list[Group]) -> None:
        self._solutes = solutes(groups)
        super().begin(state, groups)

    def carried(self, groups: list[Group]) -> list[tuple[str, float]]:
        return [*super().carried(groups), *((f, self.concentration_penalty) for f in self._solutes)]

    def ambient(self, state: State) -> dict[str, float]:
        given = {PRESSURE.name: self.ambient_pressure}
        given |= {f: self.ambient_concentration.get(f, 0.0) for f in self._solutes}
        return {f: float(as_value(v)(state.time, state.X[:1], np.zeros(1, np.int64))[0]) for f, v in given.items()}

    def moduli(self, s: Side, state: State, groups: list[Group]) -> Floats:
        return mixture(s.surface, groups, state)[s.facet]


register(SlidingMultiphasic, "sliding-multiphasic")
