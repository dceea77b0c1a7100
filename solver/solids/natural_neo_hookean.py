"""Natural (Hencky) neo-Hookean solid: quadratic in the logarithmic strain."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..jit import kernel
from ..kernels.spectral import add_spectral
from ..kernels.tensors import eigen, left_cauchy_green
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .registry import register


@kernel
def _run(F, J, par, s, c, W):
    b, w, tau, H = np.empty(6), np.empty(3), np.empty(3), np.empty((3, 3))
    A, V, N = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 6))
    for i in range(len(J)):
        m = i if par.shape[0] > 1 else 0
        kappa = par[m, 0] / (3.0 * (1.0 - 2.0 * par[m, 1]))
        mu = 0.5 * par[m, 0] / (1.0 + par[m, 1])
        left_cauchy_green(F, i, 1.0, b)
        eigen(b, A, w, V)
        mean = (math.log(w[0]) + math.log(w[1]) + math.log(w[2])) / 6.0
        if len(W) > 0:
            W[i] = 4.5 * kappa * mean * mean
            for a in range(3):
                W[i] += mu * (0.5 * math.log(w[a]) - mean) ** 2
            continue
        for a in range(3):
            tau[a] = 3.0 * kappa * mean + 2.0 * mu * (0.5 * math.log(w[a]) - mean)
            for q in range(3):
                H[a, q] = kappa - 2.0 / 3.0 * mu
            H[a, a] += 2.0 * mu
        add_spectral(s, c, i, 1.0 / J[i], w, V, tau, H, N)


@dataclass(eq=False)
class NaturalNeoHookean(Solid):
    """W = kappa (tr h)^2 / 2 + mu dev h : dev h, h = ln V; kappa and mu from E and v.

    Criscione et al., J. Mech. Phys. Solids 48 (2000) 2445.
    """

    E: Number = 0.0
    v: Number = 0.0
    parameters = ("E", "v")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        _run(pts.F, pts.J, self.par(pts), s, wanted(c), np.empty(0))

    def energy(self, pts: Points) -> Floats:
        W = np.empty(pts.n)
        _run(pts.F, pts.J, self.par(pts), W.reshape(-1, 1), wanted(None), W)
        return W


register(NaturalNeoHookean, "natural neo-Hookean")
