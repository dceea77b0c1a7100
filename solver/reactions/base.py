"""What a chemical reaction is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..multiphasic.solution import Solution
from ..points import Points
from ..reaction_rates.base import ReactionRate

Floats = NDArray[np.float64]


@dataclass(eq=False)
class Reaction:
    """Molar supply zeta (moles per fluid volume and time) of a reaction among m solutes and b solid-bound molecules.

    reactants, products (m + b,): stoichiometric coefficients; Vbar: net molar volume made. ``supply`` gives zeta (n,),
    ``by_J`` its derivative by J at fixed effective concentrations (n,), ``by_concentration`` that by those (n, m).
    Both leave out that solid-bound molecules and the porosity change with the reaction itself, as FEBio does.
    """

    reactants: Floats
    products: Floats
    Vbar: float = 0.0
    forward: ReactionRate | None = None
    reverse: ReactionRate | None = None
    net: Floats = field(init=False)

    def __post_init__(self) -> None:
        self.net = self.products - self.reactants

    @property
    def rates(self) -> list[ReactionRate]:
        return [r for r in (self.forward, self.reverse) if r is not None]

    def supply(self, pts: Points, sol: Solution) -> Floats:
        raise NotImplementedError

    def by_J(self, pts: Points, sol: Solution) -> Floats:
        raise NotImplementedError

    def by_concentration(self, pts: Points, sol: Solution) -> Floats:
        raise NotImplementedError


@dataclass(slots=True)
class MassAction:
    """k prod_i ca_i^v_i, v (m + b,), over solutes (``effective``: by effective concentrations) and what is bound."""

    law: ReactionRate
    v: Floats
    effective: bool = False
    solutes: bool = True

    def value(self, pts: Points, sol: Solution) -> Floats:
        out: Any = np.broadcast_to(self.law.rate(pts, sol), (pts.n,)).copy()
        if self.solutes:
            out *= _powers(sol.c if self.effective else sol.ca, self.v[: sol.m])
        if self.v[sol.m :].any():
            out *= _powers(sol.bound_concentration(pts.J), self.v[sol.m :])
        return out

    def by_J(self, pts: Points, sol: Solution) -> Floats:
        value, v = self.value(pts, sol), self.v
        k, dk = self.law.rate(pts, sol), self.law.by_J(pts, sol)
        rate = np.zeros(pts.n)
        if dk is not None:
            rate += np.where(k > 0.0, dk / np.where(k > 0.0, k, 1.0), 0.0)
        if self.solutes and not self.effective:
            rate += _logarithmic(sol.dkdJ, sol.kappa) @ v[: sol.m]
        return (rate - v[sol.m :].sum() / (pts.J - sol.phi0)) * value

    def by_concentration(self, pts: Points, sol: Solution) -> Floats:
        if not self.solutes:
            return np.zeros((pts.n, sol.m))
        v = self.v[: sol.m]
        rate = _logarithmic(np.ones_like(sol.c), sol.c) * v
        if not self.effective:
            rate += np.einsum("i,nij->nj", v, _logarithmic(sol.dkdc, sol.kappa[:, :, None]))
        return rate * self.value(pts, sol)[:, None]


def _powers(c: Floats, v: Floats) -> Floats:
    used = np.flatnonzero(v)
    return np.prod(c[:, used] ** v[used], axis=1)


def _logarithmic(slope: Floats, value: Floats) -> Floats:
    """slope / value, 0 where the value is not positive."""
    return np.where(value > 0.0, slope / np.where(value > 0.0, value, 1.0), 0.0)
