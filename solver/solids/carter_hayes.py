"""Neo-Hookean solid whose modulus grows with a power of its density, as that of trabecular bone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number, Solid, wanted
from .lame import shear_and_first
from .neo_hookean import add_stress, strain_energy
from .registry import register


@dataclass(eq=False)
class CarterHayes(Solid):
    """E = c rho^gamma of the referential density rho, ``pts.extra["density"]`` (n,).

    Carter & Hayes, J. Bone Joint Surg. Am. 59 (1977) 954; the neo-Hookean law is that of :mod:`.neo_hookean`.
    """

    c: Number = 0.0
    gamma: Number = 0.0
    v: Number = 0.0
    parameters = ("c", "gamma", "v")

    def exponent(self, pts: Points) -> Floats:
        """gamma (1|n,): stress and energy are proportional to rho^gamma."""
        return self.par(pts)[:, 1]

    def _moduli(self, pts: Points, density: Floats) -> Floats:
        """E and v (n, 2)."""
        c, gamma, v = self.par(pts).T
        return np.stack(np.broadcast_arrays(c * density**gamma, v), axis=1)

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        add_stress(pts.F, pts.J, self._moduli(pts, pts.extra["density"]), s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        return self.energy_at(pts, pts.extra["density"])

    def energy_at(self, pts: Points, density: Floats) -> Floats:
        """Strain energy (n,) at a density (n,)."""
        return strain_energy(pts, *shear_and_first(self._moduli(pts, density)))


register(CarterHayes, "Carter-Hayes (old)", "remodeled")
