"""Growth as a stress-free change of the reference: F = Fe Fg."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..matrices import inv
from ..points import Points
from .base import Floats, Property, Solid, deformed
from .registry import register


@dataclass(eq=False)
class KinematicGrowth(Solid):
    """sigma = sigma_0(F Fg^-1). Ateshian & Humphrey, Annu. Rev. Biomed. Eng. 14 (2012) 97."""

    elastic: Solid | None = None
    growth: Any = None
    properties = {"elastic": Property("solid"), "growth": Property("growth")}

    def _elastic_state(self, pts: Points) -> Points:
        within = self.inner(pts)
        return deformed(within, within.F @ inv(self.growth.tensor(within)))

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self.elastic.stress(self._elastic_state(pts), s, c)  # type: ignore[union-attr]

    def energy(self, pts: Points) -> Floats:
        return self.elastic.energy(self._elastic_state(pts))  # type: ignore[union-attr]


register(KinematicGrowth, "kinematic growth")
