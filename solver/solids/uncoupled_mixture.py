"""Several distortional solids that share one deformation and one volumetric law."""

from __future__ import annotations

from dataclasses import dataclass

from ..points import Points
from .base import Floats, Property, Solid
from .registry import register
from .uncoupled import Uncoupled, distortional, distortional_energy


@dataclass(eq=False)
class UncoupledMixture(Uncoupled):
    """sigma = sum of the distortional stresses + U'(J) I; a coupled solid among them adds its whole stress."""

    solid: tuple[Solid, ...] = ()
    properties = {"solid": Property("solid", many=True)}

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        within = self.inner(pts)
        for m in self.solid:
            distortional(m)(within, s, c)

    def dev_energy(self, pts: Points) -> Floats:
        within = self.inner(pts)
        return sum((distortional_energy(m, within) for m in self.solid), start=0.0 * pts.J)


register(UncoupledMixture, "uncoupled solid mixture")
