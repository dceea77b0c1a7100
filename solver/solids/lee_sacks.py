"""Isotropic Lee-Sacks solids: a neo-Hookean matrix and an exponential of the first invariant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..kernels.invariants import add_invariant
from ..points import Points
from .base import NO_TANGENT, Floats, Number, Solid
from .hyperelastic import columns
from .invariants import invariants, isochoric_invariants
from .registry import register
from .uncoupled import Uncoupled


@dataclass(eq=False)
class _LeeSacks(Solid):
    """``tangent_scale`` multiplies c0 in the tangent alone, which helps iterations far from the solution."""

    c0: Number = 0.0
    c1: Number = 0.0
    c2: Number = 0.0
    tangent_scale: Number = 1.0
    parameters: ClassVar[tuple[str, ...]] = ("c0", "c1", "c2", "tangent_scale")

    def _exponential(self, pts: Points, I1: Floats) -> tuple[Floats, Floats, Floats]:
        """c1 (exp[c2 (I1 - 3)^2] - 1) / 2 and its derivatives by I1."""
        c1, c2 = self.par(pts).T[1:3]
        x = I1 - 3.0
        e = c1 * np.exp(c2 * x * x)
        return 0.5 * (e - c1), e * c2 * x, e * c2 * (1.0 + 2.0 * c2 * x * x)

    def _add(self, pts: Points, of: Floats, scaled: Floats, iso: bool, s: Floats, c: Floats | None) -> None:
        """Stress of the derivatives ``of``, tangent of ``scaled``."""
        add_invariant(pts.F, pts.J, of, iso, s, NO_TANGENT)
        if c is not None:
            add_invariant(pts.F, pts.J, scaled, iso, np.zeros_like(s), c)


@dataclass(eq=False)
class LeeSacks(_LeeSacks):
    """W = c0 ((I1 - 3)/2 - ln J) + c1 (exp[c2 (I1 - 3)^2] - 1) / 2 + k (ln J)^2 / 2."""

    k: Number = 0.0
    parameters = (*_LeeSacks.parameters, "k")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        c0, scale, k = self.par(pts).T[[0, 3, 4]]
        _, W1, W11 = self._exponential(pts, invariants(pts)[0])
        J, lnJ = pts.J, np.log(pts.J)

        def derivatives(c0: Floats) -> Floats:
            return columns(pts, W1 + 0.5 * c0, 0.0, W11, 0.0, 0.0, (k * lnJ - c0) / J, (k - k * lnJ + c0) / J**2)

        self._add(pts, derivatives(c0), derivatives(scale * c0), False, s, c)

    def energy(self, pts: Points) -> Floats:
        c0, k = self.par(pts).T[[0, 4]]
        I1, lnJ = invariants(pts)[0], np.log(pts.J)
        return c0 * (0.5 * (I1 - 3.0) - lnJ) + self._exponential(pts, I1)[0] + 0.5 * k * lnJ**2


@dataclass(eq=False)
class LeeSacksUncoupled(_LeeSacks, Uncoupled):
    """W~ = c0 (I1~ - 3) / 2 + c1 (exp[c2 (I1~ - 3)^2] - 1) / 2."""

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        c0, scale = self.par(pts).T[[0, 3]]
        _, W1, W11 = self._exponential(pts, isochoric_invariants(pts)[0])
        of, scaled = (columns(pts, W1 + 0.5 * x, 0.0, W11) for x in (c0, scale * c0))
        self._add(pts, of, scaled, True, s, c)

    def dev_energy(self, pts: Points) -> Floats:
        I1 = isochoric_invariants(pts)[0]
        return 0.5 * self.par(pts).T[0] * (I1 - 3.0) + self._exponential(pts, I1)[0]

    stress = Uncoupled.stress
    energy = Uncoupled.energy


register(LeeSacks, "isotropic Lee-Sacks")
register(LeeSacksUncoupled, "uncoupled isotropic Lee-Sacks")
