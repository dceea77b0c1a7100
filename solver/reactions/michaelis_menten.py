"""Enzyme kinetics of Michaelis and Menten."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import Floats, Reaction


@dataclass(eq=False)
class MichaelisMenten(Reaction):
    """zeta = Vmax c / (Km + c) where c > c0, else 0; c of the one reactant, Vmax the forward rate.

    FEBio User Manual, "Michaelis-Menten Reaction".
    """

    Km: float = 0.0
    c0: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if np.count_nonzero(self.reactants) != 1 or np.count_nonzero(self.products) > 1:
            raise ValueError("a Michaelis-Menten reaction takes one vR and at most one vP")
        if self.c0 < 0.0:
            raise ValueError("c0 must not be negative")
        self.reactant = int(np.flatnonzero(self.reactants)[0])

    def _concentration(self, pts: Points, sol: Solution) -> Floats:
        i = self.reactant
        return sol.ca[:, i] if i < sol.m else sol.bound_concentration(pts.J)[:, i - sol.m]

    def supply(self, pts: Points, sol: Solution) -> Floats:
        assert self.forward is not None
        c = self._concentration(pts, sol)
        return np.where(c > self.c0, self.forward.rate(pts, sol) * c / (self.Km + c), 0.0)

    def _slope(self, pts: Points, sol: Solution, c: Floats) -> Floats:
        """d zeta / d c at a constant rate."""
        assert self.forward is not None
        return np.where(c > self.c0, self.forward.rate(pts, sol) * self.Km / (self.Km + c) ** 2, 0.0)

    def by_J(self, pts: Points, sol: Solution) -> Floats:
        c, i = self._concentration(pts, sol), self.reactant
        dc = sol.dkdJ[:, i] * sol.c[:, i] if i < sol.m else -c / (pts.J - sol.phi0)
        return self._slope(pts, sol, c) * dc

    def by_concentration(self, pts: Points, sol: Solution) -> Floats:
        c, i = self._concentration(pts, sol), self.reactant
        if i >= sol.m:
            return np.zeros((pts.n, sol.m))
        return self._slope(pts, sol, c)[:, None] * sol.by_concentration(i)


register(MichaelisMenten, "Michaelis-Menten")
