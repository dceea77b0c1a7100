"""Membrane reactions by the law of mass action."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats
from ..membrane_rates.base import MembraneRate
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import MembraneReaction


@dataclass(slots=True)
class Action:
    """k prod_i ca_i^v_i prod_b s_b^v_b prod_k c_k^V_k, v (m + b,), V (2, M).

    The shell's solutes by actual concentrations, its bound molecules by areal ones s, those outside by effective ones.
    """

    law: MembraneRate
    v: Floats
    V: Floats

    def value(self, pts: Points, sol: Solution) -> Floats:
        return np.broadcast_to(self.law.rate(pts, sol), (pts.n,)) * self._powers(pts, sol)

    def _powers(self, pts: Points, sol: Solution) -> Floats:
        assert sol.sides is not None
        out: Floats = np.prod(sol.sides.c**self.V, axis=(1, 2)) * np.prod(sol.ca ** self.v[: sol.m], axis=1)
        if self.v[sol.m :].any():
            out *= np.prod(sol.areal_concentration(pts.J) ** self.v[sol.m :], axis=1)
        return out

    def by_own(self, pts: Points, sol: Solution) -> tuple[Floats, Floats]:
        """Derivatives by J (n,) and the shell's own effective concentrations (n, m), areal concentrations held."""
        ca = np.where(sol.ca > 0.0, sol.ca, 1.0)
        each = np.where(sol.ca > 0.0, self.v[: sol.m] / ca, 0.0) * self.value(pts, sol)[:, None]
        slopes = sol.c[:, :, None] * sol.dkdc
        slopes[:, range(sol.m), range(sol.m)] += sol.kappa
        by_c: Floats = np.einsum("ni,nij->nj", each, slopes)
        return (each * sol.c * sol.dkdJ).sum(axis=1), by_c

    def by_sides(self, pts: Points, sol: Solution) -> Floats:
        assert sol.sides is not None
        c = sol.sides.c
        out: Floats = np.where(c > 0.0, self.V / np.where(c > 0.0, c, 1.0), 0.0) * self.value(pts, sol)[:, None, None]
        rate = self.law.by_sides(pts, sol)
        return out if rate is None else out + rate * self._powers(pts, sol)[:, None, None]

    def by_strain(self, pts: Points, sol: Solution) -> Floats:
        """Areal concentrations of what is bound fall as the area grows."""
        assert sol.sides is not None
        out: Floats = -self.v[sol.m :].sum() * self.value(pts, sol) / sol.sides.strain
        rate = self.law.by_strain(pts, sol)
        return out if rate is None else out + rate * self._powers(pts, sol)


@dataclass(eq=False)
class Forward(MembraneReaction):
    """zeta = k prod c^vR over the reactants inside the shell and on its faces.

    FEBio User Manual, "Membrane Reactions". FEBio 4.11 looks up the coefficients of reactants behind by their own
    values, so that it does not know most of them: here they count.
    """

    def _actions(self) -> list[tuple[float, Action]]:
        """Signs and terms of zeta."""
        assert isinstance(self.forward, MembraneRate)
        return [(1.0, Action(self.forward, self.reactants, self.reactants_outside))]

    def supply(self, pts: Points, sol: Solution) -> Floats:
        return np.asarray(sum(s * a.value(pts, sol) for s, a in self._actions()))

    def by_J(self, pts: Points, sol: Solution) -> Floats:
        return np.asarray(sum(s * a.by_own(pts, sol)[0] for s, a in self._actions()))

    def by_concentration(self, pts: Points, sol: Solution) -> Floats:
        return np.asarray(sum(s * a.by_own(pts, sol)[1] for s, a in self._actions()))

    def by_sides(self, pts: Points, sol: Solution) -> Floats:
        return np.asarray(sum(s * a.by_sides(pts, sol) for s, a in self._actions()))

    def by_strain(self, pts: Points, sol: Solution) -> Floats:
        return np.asarray(sum(s * a.by_strain(pts, sol) for s, a in self._actions()))


@dataclass(eq=False)
class Reversible(Forward):
    """zeta = kF prod c^vR - kR prod c^vP over reactants and products."""

    def _actions(self) -> list[tuple[float, Action]]:
        assert isinstance(self.reverse, MembraneRate)
        return [*Forward._actions(self), (-1.0, Action(self.reverse, self.products, self.products_outside))]


register(Forward, "membrane-mass-action-forward")
register(Reversible, "membrane-mass-action-reversible")
