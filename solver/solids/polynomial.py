"""Polynomial of both invariants and of the volume."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.invariants import add_invariant
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .hyperelastic import columns
from .invariants import isochoric_invariants
from .registry import register
from .uncoupled import add_volumetric

_POWERS = ((0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (2, 0), (2, 1), (2, 2))  # of I1~ - 3 and of I2~ - 3


def _power(x: Floats, n: int, order: int) -> Floats:
    """Derivative of this order of x^n, n <= 2."""
    return (x**n, n * x ** max(n - 1, 0), np.full_like(x, n * (n - 1)))[order]


@dataclass(eq=False)
class Polynomial(Solid):
    """W = sum_ij c_ij (I1~ - 3)^i (I2~ - 3)^j + D1 (J - 1)^2 + D2 (J - 1)^4, i, j <= 2."""

    c01: Number = 0.0
    c02: Number = 0.0
    c10: Number = 0.0
    c11: Number = 0.0
    c12: Number = 0.0
    c20: Number = 0.0
    c21: Number = 0.0
    c22: Number = 0.0
    D1: Number = 0.0
    D2: Number = 0.0
    parameters = ("c01", "c02", "c10", "c11", "c12", "c20", "c21", "c22", "D1", "D2")

    def _sum(self, pts: Points, a: int, b: int) -> Floats:
        """Derivative of the sum, ``a`` times by I1~ and ``b`` times by I2~."""
        x, y = (i - 3.0 for i in isochoric_invariants(pts))
        terms = (c * _power(x, i, a) * _power(y, j, b) for c, (i, j) in zip(self.par(pts).T, _POWERS))
        return sum(terms, start=np.zeros(pts.n))

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        D = columns(pts, *(self._sum(pts, a, b) for a, b in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))))
        add_invariant(pts.F, pts.J, D, True, s, wanted(c))
        (D1, D2), x = self.par(pts).T[8:], pts.J - 1.0
        add_volumetric(pts.J, 2.0 * D1 * x + 4.0 * D2 * x**3, 2.0 * D1 + 12.0 * D2 * x**2, s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        (D1, D2), x = self.par(pts).T[8:], pts.J - 1.0
        return self._sum(pts, 0, 0) + D1 * x**2 + D2 * x**4


register(Polynomial, "polynomial")
