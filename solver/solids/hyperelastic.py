"""Isotropic solids given by derivatives of W(I1, I2, J) at the points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.invariants import add_invariant
from ..points import Points
from .base import Floats, Solid, wanted
from .invariants import invariants, isochoric_invariants
from .uncoupled import Uncoupled


def columns(pts: Points, *derivatives: Floats | float) -> Floats:
    """Array (n, 7) of W1, W2, W11, W12, W22, WJ, WJJ; what is left out is zero."""
    D = np.zeros((pts.n, 7))
    for k, d in enumerate(derivatives):
        D[:, k] = d
    return D


@dataclass(eq=False)
class Hyperelastic(Solid):
    """Compressible; subclasses give ``derivatives(pts, I1, I2, J)`` (n, 7) and ``potential`` (n,)."""

    def derivatives(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        raise NotImplementedError

    def potential(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        raise NotImplementedError(f"{type(self).__name__} gives no strain energy")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        add_invariant(pts.F, pts.J, self.derivatives(pts, *invariants(pts), pts.J), False, s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        return self.potential(pts, *invariants(pts), pts.J)


@dataclass(eq=False)
class UncoupledHyperelastic(Uncoupled):
    """Nearly incompressible; ``derivatives(pts, I1, I2)`` by the invariants of F~."""

    def derivatives(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        raise NotImplementedError

    def potential(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        raise NotImplementedError(f"{type(self).__name__} gives no strain energy")

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        D = self.derivatives(pts, *isochoric_invariants(pts))
        add_invariant(pts.F, pts.J, D, True, s, wanted(c))

    def dev_energy(self, pts: Points) -> Floats:
        return self.potential(pts, *isochoric_invariants(pts))
