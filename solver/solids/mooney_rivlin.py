"""Nearly incompressible Mooney-Rivlin solid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..jit import kernel
from ..kernels.isochoric import add_isochoric
from ..kernels.tensors import left_cauchy_green, square, trace
from ..points import Points
from .base import Floats, Number, wanted
from .invariants import isochoric_invariants
from .registry import register
from .uncoupled import Uncoupled


@kernel
def run(F, J, par, s, c):
    """Columns 0 and 1 of ``par`` are c1 and c2."""
    b, b2, T, h = np.empty(6), np.empty(6), np.empty(6), np.empty((1, 6, 6))
    for i in range(len(J)):
        m = i if par.shape[0] > 1 else 0
        left_cauchy_green(F, i, J[i] ** (-2.0 / 3.0), b)
        square(b, b2)
        add_isochoric(s, c, i, 1.0 / J[i], b, b2, trace(b), par[m, 0], par[m, 1], 0.0, 0.0, 0.0, T, h)


@dataclass(eq=False)
class MooneyRivlin(Uncoupled):
    """W~ = c1 (I1~ - 3) + c2 (I2~ - 3)."""

    c1: Number = 0.0
    c2: Number = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("c1", "c2")

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        run(pts.F, pts.J, self.par(pts), s, wanted(c))

    def dev_energy(self, pts: Points) -> Floats:
        I1, I2 = isochoric_invariants(pts)
        c1, c2 = self.par(pts)[:, :2].T
        return c1 * (I1 - 3.0) + c2 * (I2 - 3.0)


@dataclass(eq=False)
class MooneyRivlinAD(MooneyRivlin):
    """The same law; FEBio 4.11 itself ends in a fault where a model uses it."""


register(MooneyRivlin, "Mooney-Rivlin")
register(MooneyRivlinAD, "Mooney-Rivlin AD")
