"""Compressible Ogden solid."""

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
        cp = par[m, 0]
        left_cauchy_green(F, i, 1.0, b)
        eigen(b, A, w, V)
        if len(W) > 0:
            W[i] = 0.5 * cp * (J[i] - 1.0) ** 2
        for a in range(3):
            tau[a] = cp * J[i] * (J[i] - 1.0)
            for q in range(3):
                H[a, q] = cp * J[i] * (2.0 * J[i] - 1.0)
            for t in range(6):
                ct, mt = par[m, 1 + t], par[m, 7 + t]
                if ct != 0.0:
                    x = w[a] ** (0.5 * mt)
                    tau[a] += ct / mt * (x - 1.0)
                    H[a, a] += ct * x
                    if len(W) > 0:
                        W[i] += ct / (mt * mt) * (x - 1.0 - 0.5 * mt * math.log(w[a]))
        if len(W) == 0:
            add_spectral(s, c, i, 1.0 / J[i], w, V, tau, H, N)


@dataclass(eq=False)
class OgdenUnconstrained(Solid):
    """W = cp (J - 1)^2 / 2 + sum_i c_i / m_i^2 (l1^m_i + l2^m_i + l3^m_i - 3 - m_i ln J)."""

    cp: Number = 0.0
    c1: Number = 0.0
    c2: Number = 0.0
    c3: Number = 0.0
    c4: Number = 0.0
    c5: Number = 0.0
    c6: Number = 0.0
    m1: Number = 1.0
    m2: Number = 1.0
    m3: Number = 1.0
    m4: Number = 1.0
    m5: Number = 1.0
    m6: Number = 1.0
    parameters = ("cp", "c1", "c2", "c3", "c4", "c5", "c6", "m1", "m2", "m3", "m4", "m5", "m6")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        _run(pts.F, pts.J, self.par(pts), s, wanted(c), np.empty(0))

    def energy(self, pts: Points) -> Floats:
        W = np.empty(pts.n)
        _run(pts.F, pts.J, self.par(pts), W.reshape(-1, 1), wanted(None), W)
        return W


register(OgdenUnconstrained, "Ogden unconstrained")
