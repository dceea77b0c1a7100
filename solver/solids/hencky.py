"""Isotropic Hencky solid."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..jit import kernel
from ..kernels.spectral import add_spectral
from ..kernels.tensors import eigen, left_cauchy_green
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .lame import lame
from .registry import register


@kernel
def _run(F, J, par, s, c, W):
    b, w, tau, H = np.empty(6), np.empty(3), np.empty(3), np.empty((3, 3))
    A, V, N = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 6))
    for i in range(len(J)):
        m = i if par.shape[0] > 1 else 0
        lam, mu = lame(par[m, 0], par[m, 1])
        left_cauchy_green(F, i, 1.0, b)
        eigen(b, A, w, V)
        lnJ = math.log(J[i])
        if len(W) > 0:
            W[i] = 0.5 * lam * lnJ * lnJ
            for a in range(3):
                W[i] += 0.25 * mu * math.log(w[a]) ** 2
            continue
        for a in range(3):
            tau[a] = lam * lnJ + mu * math.log(w[a])
            for q in range(3):
                H[a, q] = lam
            H[a, a] += 2.0 * mu
        add_spectral(s, c, i, 1.0 / J[i], w, V, tau, H, N)


@dataclass(eq=False)
class Hencky(Solid):
    """W = lambda (ln J)^2 / 2 + mu h : h, h = ln V."""

    E: Number = 0.0
    v: Number = 0.0
    parameters = ("E", "v")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        _run(pts.F, pts.J, self.par(pts), s, wanted(c), np.empty(0))

    def energy(self, pts: Points) -> Floats:
        W = np.empty(pts.n)
        _run(pts.F, pts.J, self.par(pts), W.reshape(-1, 1), wanted(None), W)
        return W


register(Hencky, "isotropic Hencky")
