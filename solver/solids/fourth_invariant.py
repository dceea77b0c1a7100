"""Solids with one fiber direction a0 given by derivatives of W(I1, I2, I4, I5, J)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..kernels.fourth_invariant import fiber_invariants, fiber_stress, fiber_tangent
from ..points import Points
from .base import Floats, Property, Solid
from .fiber import directions
from .secant import central_tangent
from .uncoupled import Uncoupled


def invariants(pts: Points, a0: Floats, iso: bool) -> dict[str, Floats]:
    """I1, I2, I4, I5 (n,) for reference directions a0 (1|n, 3); of F~ where ``iso``."""
    out = np.empty((4, pts.n))
    fiber_invariants(pts.F, pts.J, a0, iso, out)
    return dict(zip(("I1", "I2", "I4", "I5"), out, strict=True))


@dataclass(eq=False)
class FourthInvariant(Solid):
    """sigma = 2/J [(W1 + I1 W2) b - W2 b^2 + I4 W4 n n + I4 W5 (n bn + bn n)] + WJ I; tangent by differences."""

    iso = False
    fiber: Any = field(default=None, kw_only=True)
    properties = {"fiber": Property("direction", default="vector")}

    def derivatives(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        """W1, W2, W4, W5 and, where compressible, WJ."""
        raise NotImplementedError

    def second(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        """W11, W14, W15, W44, W45, W55, of a law without I2 and J; empty where the tangent is taken by differences."""
        return ()

    def _first(self, pts: Points, i: dict[str, Floats]) -> Floats:
        """:meth:`derivatives` as columns (n, 5)."""
        W = np.zeros((pts.n, 5))
        for k, w in enumerate(self.derivatives(pts, i)):
            W[:, k] = w
        return W

    def _cauchy(self, pts: Points) -> Floats:
        a0, s = directions(self.fiber, pts), np.empty((pts.n, 6))
        fiber_stress(pts.F, pts.J, a0, self.iso, self._first(pts, invariants(pts, a0, self.iso)), s)
        return s

    def _tangent(self, pts: Points) -> Floats:
        return central_tangent(self._cauchy, pts)

    def _add(self, pts: Points, s: Floats, c: Floats | None) -> None:
        within = self.inner(pts)
        a0, own = directions(self.fiber, within), np.empty((pts.n, 6))
        i = invariants(within, a0, self.iso)
        W = self._first(within, i)
        fiber_stress(within.F, within.J, a0, self.iso, W, own)
        s += own
        if c is None:
            return
        second = self.second(within, i)
        if not second:
            c += self._tangent(within)
            return
        H = np.empty((pts.n, 6))
        for k, w in enumerate(second):
            H[:, k] = w
        fiber_tangent(within.F, within.J, a0, self.iso, W, H, c)

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c)


@dataclass(eq=False)
class UncoupledFourthInvariant(FourthInvariant, Uncoupled):
    """The deviatoric part, of F~."""

    iso = True

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c)

    stress = Uncoupled.stress
    energy = Uncoupled.energy
