"""Neo-Hookean solid whose modulus grows with a power of what is bound to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number, Solid, wanted
from .bound import Bound
from .lame import shear_and_first
from .neo_hookean import add_stress, strain_energy
from .registry import register


@dataclass(eq=False)
class CarterHayesBound(Bound, Solid):
    """E = E0 (rho / rho0)^gamma.

    Carter & Hayes, J. Bone Joint Surg. Am. 59 (1977) 954; FEBio User Manual, "Carter-Hayes".
    """

    E0: Number = 0.0
    v: Number = 0.0
    rho0: Number = 1.0
    gamma: Number = 0.0
    sbm: int | str = 0
    parameters = ("E0", "v", "rho0", "gamma")

    def _moduli(self, pts: Points) -> Floats:
        """E and v (1|n, 2)."""
        E0, v = self.par(pts)[:, :2].T
        return np.stack(np.broadcast_arrays(E0 * self.factor(pts), v), axis=1)

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        add_stress(pts.F, pts.J, self._moduli(pts), s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        return strain_energy(pts, *shear_and_first(self._moduli(pts)))


register(CarterHayesBound, "Carter-Hayes")
