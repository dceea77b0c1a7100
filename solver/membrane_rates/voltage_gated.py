"""Rate of passage through voltage-gated channels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import OfOneSolute


@dataclass(eq=False)
class VoltageGated(OfOneSolute):
    """k = (c ln x + d) / (a + x^b), x = c_i / c_e of solute ``sol`` (its place in the model); 0 where either is 0.

    FEBio User Manual, "Membrane Voltage-Gated Reaction Rate".
    """

    a: Number = 0.0
    b: Number = 0.0
    c: Number = 0.0
    d: Number = 0.0
    sol: int = 0
    parameters = ("a", "b", "c", "d")
    needed = ("sol",)

    def _terms(self, pts: Points, sol: Solution) -> tuple[Floats, Floats]:
        """k and x dk/dx (n,)."""
        a, b, c, d = self.par(pts).T
        e, i = self.of(sol, self.sol)
        both = (e > 0.0) & (i > 0.0)
        log = np.log(np.where(both, i, 1.0) / np.where(both, e, 1.0))
        xb = np.exp(b * log)
        k = (c * log + d) / (a + xb)
        return np.where(both, k, 0.0), np.where(both, (c - k * b * xb) / (a + xb), 0.0)

    def rate(self, pts: Points, sol: Solution) -> Floats:
        return self._terms(pts, sol)[0]

    def by_sides(self, pts: Points, sol: Solution) -> Floats:
        slope = self._terms(pts, sol)[1]
        e, i = (np.where(q > 0.0, q, 1.0) for q in self.of(sol, self.sol))
        return self.spread(sol, self.sol, -slope / e, slope / i)


register(VoltageGated, "membrane voltage-gated reaction rate")
