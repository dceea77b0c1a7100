"""Holmes-Mow solid: neo-Hookean-like with an exponential stiffening, for cartilage."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..jit import kernel
from ..kernels.tensors import add_circle, add_dyad, add_identity, left_cauchy_green, square, trace
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .lame import lame
from .registry import register


@kernel
def _run(F, J, par, s, c, W):
    b, b2, t = np.empty(6), np.empty(6), np.zeros(6)
    for i in range(len(J)):
        m = i if par.shape[0] > 1 else 0
        lam, mu = lame(par[m, 0], par[m, 1])
        beta = par[m, 2]
        Ha = lam + 2.0 * mu
        left_cauchy_green(F, i, 1.0, b)
        square(b, b2)
        I1 = trace(b)
        I2 = 0.5 * (I1 * I1 - trace(b2))
        Q = beta * ((2.0 * mu - lam) * (I1 - 3.0) + lam * (I2 - 3.0)) / Ha
        eQ = math.exp(Q) / J[i] ** (2.0 * beta)
        if len(W) > 0:
            W[i] = 0.25 * Ha / beta * (eQ - 1.0)
            continue
        h = 0.5 * eQ / J[i]
        g = 2.0 * mu + lam * (I1 - 1.0)
        for a in range(6):
            t[a] = h * (g * b[a] - lam * b2[a])
        for a in range(3):
            t[a] -= h * Ha
        for a in range(6):
            s[i, a] += t[a]
        if c.shape[0] > 0:
            add_dyad(c, i, 4.0 * beta / Ha * J[i] / eQ, t)
            add_dyad(c, i, 2.0 * h * lam, b)
            add_circle(c, i, -2.0 * h * lam, b)
            add_identity(c, i, 0.0, 2.0 * h * Ha)


@dataclass(eq=False)
class HolmesMow(Solid):
    """W = Ha (exp Q - 1) / (4 beta), Q = beta [(2 mu - lambda)(I1 - 3) + lambda (I2 - 3)] / Ha - beta ln J^2.

    Holmes & Mow, J. Biomech. 23 (1990) 1145; Ha = lambda + 2 mu.
    """

    E: Number = 0.0
    v: Number = 0.0
    beta: Number = 0.0
    parameters = ("E", "v", "beta")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        _run(pts.F, pts.J, self.par(pts), s, wanted(c), np.empty(0))

    def energy(self, pts: Points) -> Floats:
        W = np.empty(pts.n)
        _run(pts.F, pts.J, self.par(pts), W.reshape(-1, 1), wanted(None), W)
        return W


register(HolmesMow, "Holmes-Mow")
