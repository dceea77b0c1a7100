"""Rate switched by exposure to a solute, and again by its release."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import ReactionRate


@dataclass(eq=False)
class Nims(ReactionRate):
    """k0 + (kc - k0) min(cmax / cc, 1) before time ``trel``, k0 + (kr - k0) min(cmax / cr, 1) from then on.

    cmax is the largest actual concentration of solute ``sol`` (its index in the material) met so far at the point;
    trel = 0: no release. Nims, Cigan, Albro, Hung, Ateshian, J. Biomech. 47 (2014) 2165.
    """

    sol: int = 0
    k0: Number = 0.0
    kc: Number = 0.0
    kr: Number = 0.0
    cc: Number = 1.0
    cr: Number = 1.0
    trel: Number = 0.0
    parameters = ("k0", "kc", "kr", "cc", "cr", "trel")
    needed = ("sol",)
    remembers = True

    def rate(self, pts: Points, sol: Solution) -> Floats:
        k0, kc, kr, cc, cr, trel = self.par(pts).T
        most = np.maximum(sol.ca[:, self.sol], sol.memory[id(self)])
        released = (trel > 0.0) & (pts.t >= trel)
        final, half = np.where(released, kr, kc), np.where(released, cr, cc)
        return k0 + (final - k0) * np.minimum(most / half, 1.0)

    def begin_step(self, pts: Points, sol: Solution) -> None:
        np.maximum(sol.memory[id(self)], sol.ca[:, self.sol], out=sol.memory[id(self)])


register(Nims, "Nims reaction rate")
