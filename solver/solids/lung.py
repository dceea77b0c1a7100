"""Lung parenchyma: a compressible solid with power laws of distortion and of volume."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.invariants import add_invariant
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .hyperelastic import columns
from .invariants import invariants, isochoric_invariants
from .registry import register


def _power(y: Floats, d: Floats) -> tuple[Floats, Floats, Floats]:
    """y^d and its first and second derivative; |y|^d where d is no whole number, which FEBio has for y > 0 alone."""
    whole = d == np.rint(d)
    x, sign = np.where(whole, y, np.abs(y)), np.where(whole, 1.0, np.sign(y))
    return x**d, sign * d * x ** (d - 1.0), d * (d - 1.0) * x ** (d - 2.0)


@dataclass(eq=False)
class Lung(Solid):
    """W = c (I1 - 3) + c/b (J^-2b - 1) + c1 (J^-2/3 I1 - 3)^d1 + c3 (J^2/3 - 1)^d3.

    c = E / (4 (1 + v)), b = v / (1 - 2 v). Birzle et al., J. Mech. Behav. Biomed. Mater. 94 (2019) 126.
    """

    E: Number = 0.0
    v: Number = 0.0
    c1: Number = 0.0
    c3: Number = 0.0
    d1: Number = 0.0
    d3: Number = 0.0
    parameters = ("E", "v", "c1", "c3", "d1", "d3")

    def _terms(self, pts: Points) -> tuple[Floats, ...]:
        """c, b, c1, c3, d1, d3, the isochoric I1~ - 3 and J^2/3 - 1."""
        E, v, c1, c3, d1, d3 = self.par(pts).T
        x = np.maximum(isochoric_invariants(pts)[0] - 3.0, 0.0)  # never negative but for rounding
        return 0.25 * E / (1.0 + v), v / (1.0 - 2.0 * v), c1, c3, d1, d3, x, pts.J ** (2.0 / 3.0) - 1.0

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        c0, b, c1, c3, d1, d3, x, y = self._terms(pts)
        J = pts.J
        _, slope, bend = _power(y, d3)
        grown = c3 * slope
        WJ = -2.0 * c0 * J ** (-2.0 * b - 1.0) + 2.0 / 3.0 * grown * J ** (-1.0 / 3.0)
        WJJ = 2.0 * c0 * (2.0 * b + 1.0) * J ** (-2.0 * b - 2.0) - 2.0 / 9.0 * grown * J ** (-4.0 / 3.0)
        WJJ += 4.0 / 9.0 * c3 * bend * J ** (-2.0 / 3.0)
        add_invariant(pts.F, J, columns(pts, c0, 0.0, 0.0, 0.0, 0.0, WJ, WJJ), False, s, wanted(c))
        W1, W11 = c1 * d1 * x ** (d1 - 1.0), c1 * d1 * (d1 - 1.0) * x ** (d1 - 2.0)
        add_invariant(pts.F, J, columns(pts, W1, 0.0, W11), True, s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        c0, b, c1, c3, d1, d3, x, y = self._terms(pts)
        volume = c0 / b * (pts.J ** (-2.0 * b) - 1.0) + c3 * _power(y, d3)[0]
        return c0 * (invariants(pts)[0] - 3.0) + volume + c1 * x**d1


register(Lung, "lung")
