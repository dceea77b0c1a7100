"""Compressible Mooney-Rivlin solid."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..jit import kernel
from ..kernels.tensors import add_circle, add_dyad, add_identity, left_cauchy_green, square, trace
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .registry import register


@kernel
def _run(F, J, par, s, c):
    b, b2 = np.empty(6), np.empty(6)
    for i in range(len(J)):
        m = i if par.shape[0] > 1 else 0
        c1, c2, k = par[m, 0], par[m, 1], par[m, 2]
        left_cauchy_green(F, i, 1.0, b)
        square(b, b2)
        I1 = trace(b)
        Ji = 1.0 / J[i]
        lnJ = math.log(J[i])
        for a in range(6):
            s[i, a] += 2.0 * Ji * ((c1 + I1 * c2) * b[a] - c2 * b2[a])
        for a in range(3):
            s[i, a] += Ji * (k * lnJ - 2.0 * (c1 + 2.0 * c2))
        if c.shape[0] > 0:
            add_dyad(c, i, 4.0 * c2 * Ji, b)
            add_circle(c, i, -4.0 * c2 * Ji, b)
            add_identity(c, i, k * Ji, Ji * (4.0 * (c1 + 2.0 * c2) - 2.0 * k * lnJ))


@dataclass(eq=False)
class CoupledMooneyRivlin(Solid):
    """W = c1 (I1 - 3) + c2 (I2 - 3) - 2 (c1 + 2 c2) ln J + k (ln J)^2 / 2."""

    c1: Number = 0.0
    c2: Number = 0.0
    k: Number = 0.0
    parameters = ("c1", "c2", "k")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        _run(pts.F, pts.J, self.par(pts), s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        c1, c2, k = self.par(pts).T
        C = np.swapaxes(pts.F, 1, 2) @ pts.F
        I1 = np.trace(C, axis1=1, axis2=2)
        I2 = 0.5 * (I1**2 - (C**2).sum((1, 2)))
        lnJ = np.log(pts.J)
        return c1 * (I1 - 3) + c2 * (I2 - 3) - 2 * (c1 + 2 * c2) * lnJ + 0.5 * k * lnJ**2


register(CoupledMooneyRivlin, "coupled Mooney-Rivlin")
