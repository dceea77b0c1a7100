"""Solutes that pass between surfaces in contact: a flux jn = L + eps (c1 - c2) per current area of each.

Where fluid passes, so do the solutes that both surfaces have (:mod:`.fluid`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import fluid
from .base import Floats, Matrices, Side
from .penalty import conductance

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State



@dataclass(slots=True)
class Passage:
    """One solute at the points of a side: where both facets have it, c1 - c2, multiplier and conductance (q,)."""

    field: str
    open: NDArray[np.bool_]
    step: Floats
    multiplier: Floats
    conductance: Floats


class Passages:
    """What passes through the points of a side, by the names of nodal fields."""

    def __init__(self, s: Side, groups: list[Group], automatic: bool) -> None:
        self.here: dict[str, NDArray[np.bool_]] = {}
        self.side = s
        every = dict.fromkeys(n for g in groups for n in g.fields if n.startswith("concentration"))
        self.all: list[Passage] = []
        for field in every:
            here, there = fluid.porous(s.surface, groups, field), fluid.porous(s.other, groups, field)
            if here.any() and there.any():
                ease = conductance(s.surface, groups, field)[s.facet] if automatic else np.ones(s.n)
                self.here[field], none = here, np.zeros(s.n)
                self.all.append(Passage(field, np.zeros(s.n, bool), none, none.copy(), ease))
        self._there = {p.field: fluid.porous(s.other, groups, p.field) for p in self.all}

    def update(self, state: State, touching: NDArray[np.bool_]) -> None:
        """Differences of concentration at the points that touch; elsewhere multipliers are forgotten."""
        for p in self.all:
            p.open = fluid.both(self.side, self.here[p.field], self._there[p.field]) & touching
            c1, c2 = fluid.pressures(self.side, state, p.field)
            p.step = np.where(p.open, c1 - c2, 0.0)
            p.multiplier = np.where(p.open, p.multiplier, 0.0)

    def flux(self, p: Passage, penalty: float, acting: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """jn and eps (q,), zero where nothing passes."""
        on = p.open & acting
        eps = np.where(on, penalty * p.conductance, 0.0)
        return np.where(on, p.multiplier, 0.0) + eps * p.step, eps

    def residual(self, state: State, penalty: float, acting: NDArray[np.bool_], R: Floats) -> None:
        """Add what passes within the step to the rows of the concentrations."""
        s = self.side
        for p in self.all:
            fluid.spread(state, s, state.dt * self.flux(p, penalty, acting)[0] * s.detJ * s.surface.weight, R, p.field)

    def stiffness(self, state: State, penalty: float, acting: NDArray[np.bool_], active: Any, kernel: Any) -> Matrices:
        """Matrices over displacements and each concentration; ``kernel(p, jn, eps, rows, a, b, K)`` fills them."""
        out = []
        for p in self.all:
            jn, eps = self.flux(p, penalty, acting)
            for rows, a, b, nodes in self.side.pairs(active):
                K, unknowns, columns = fluid.unknowns(state, nodes, p.field)
                kernel(p, jn, eps, rows, a, b, K)
                out.append((K, unknowns, columns))
        return out

    def augment(self, penalty: float, touching: NDArray[np.bool_]) -> list[tuple[float, float]]:
        """Take the fluxes as multipliers; per solute the sum of squares of its differences, and the largest."""
        out = []
        for p in self.all:
            step = np.where(touching, p.step, 0.0)
            p.multiplier = np.where(touching, p.multiplier + penalty * p.conductance * step, 0.0)
            out.append((float((step**2).sum()), float(np.abs(step).max(initial=0.0))))
        return out

    def snapshot(self) -> list[Floats]:
        return [p.multiplier.copy() for p in self.all]

    def restore(self, saved: list[Floats]) -> None:
        for p, multiplier in zip(self.all, saved, strict=True):
            p.multiplier = multiplier.copy()


def settled(
    sides: list[list[tuple[float, float]]], traction: float, RT: float, tolerance: float, ctol: float
) -> bool:
    """Are the differences of concentration small beside tractions / (R T), and below ctol?"""
    for steps in zip(*sides, strict=False):
        total, worst = sum(a for a, _ in steps), max(b for _, b in steps)
        scale = traction / RT if RT > 0.0 and traction > 0.0 else 1.0
        if 0.0 < tolerance < total / scale or 0.0 < ctol < worst:
            return False
    return True
