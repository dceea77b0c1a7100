"""Fibrous solid that stiffens along directions of tension (Shenoy)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..jit import kernel
from ..kernels.isochoric import add_isochoric
from ..kernels.spectral import add_spectral
from ..kernels.tensors import add_identity, eigen, left_cauchy_green, square, trace
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .registry import register


@kernel
def _run(F, J, par, s, c):
    b, b2, w, tau, H = np.empty(6), np.empty(6), np.empty(3), np.empty(3), np.empty((3, 3))
    A, V, N, T, h = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 6)), np.empty(6), np.empty((1, 6, 6))
    for i in range(len(J)):
        r = i if par.shape[0] > 1 else 0
        mu, k, Ef, lam_c, lam_t, n, m = par[r]
        left_cauchy_green(F, i, J[i] ** (-2.0 / 3.0), b)
        square(b, b2)
        add_isochoric(s, c, i, 1.0 / J[i], b, b2, trace(b), 0.5 * mu, 0.0, 0.0, 0.0, 0.0, T, h)
        p = k * (J[i] - 1.0)
        for a in range(3):
            s[i, a] += p
        if c.shape[0] > 0:
            add_identity(c, i, p + k * J[i], -2.0 * p)
        left_cauchy_green(F, i, 1.0, b)
        eigen(b, A, w, V)
        lo, hi = lam_c - 0.5 * lam_t, lam_c + 0.5 * lam_t
        for a in range(3):
            l = math.sqrt(w[a])
            f, df = 0.0, 0.0
            if l > hi:
                f = Ef * ((hi - lo) / (n + 1.0) + ((1.0 + l - hi) ** (m + 1.0) - 1.0) / (m + 1.0))
                df = Ef * (1.0 + l - hi) ** m
            elif l >= lo and hi > lo:
                x = (l - lo) / (hi - lo)
                f = Ef * x**n * (l - lo) / (n + 1.0)
                df = Ef * x**n
            tau[a] = l * f
            for q in range(3):
                H[a, q] = 0.0
            H[a, a] = l * (f + l * df)
        add_spectral(s, c, i, 1.0 / J[i], w, V, tau, H, N)


@dataclass(eq=False)
class Shenoy(Solid):
    """W = mu (I1~ - 3) / 2 + k (J - 1)^2 / 2 + sum_a f(l_a), f' = 0 below lam_c - lam_t/2, stiffening beyond.

    Wang et al., Biophys. J. 107 (2014) 2592.
    """

    mu: Number = 0.0
    k: Number = 0.0
    Ef: Number = 0.0
    lam_c: Number = 1.0
    lam_t: Number = 0.0
    n: Number = 5.0
    m: Number = 1.0
    parameters = ("mu", "k", "Ef", "lam_c", "lam_t", "n", "m")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        _run(pts.F, pts.J, self.par(pts), s, wanted(c))


register(Shenoy, "Shenoy")
