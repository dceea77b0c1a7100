"""Several solids that share one deformation: their stresses add."""

from __future__ import annotations

from dataclasses import dataclass

from ..points import Points
from .base import Floats, Property, Solid
from .registry import register


@dataclass(eq=False)
class SolidMixture(Solid):
    """sigma = sum of the stresses of the solids."""

    solid: tuple[Solid, ...] = ()
    properties = {"solid": Property("solid", many=True)}

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        within = self.inner(pts)
        for solid in self.solid:
            solid.stress(within, s, c)

    def energy(self, pts: Points) -> Floats:
        within = self.inner(pts)
        return sum((m.energy(within) for m in self.solid), start=0.0 * pts.J)


register(SolidMixture, "solid mixture")
