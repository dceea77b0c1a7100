"""Nearly incompressible Ogden solid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..jit import kernel
from ..kernels.spectral import add_spectral
from ..kernels.tensors import (
    add_deviatoric_stress,
    add_deviatoric_tangent,
    clear,
    eigen,
    left_cauchy_green,
)
from ..points import Points
from .base import Floats, Number, wanted
from .registry import register
from .uncoupled import Uncoupled


@kernel
def _run(F, J, par, s, c, W):
    b, w, tau, H = np.empty(6), np.empty(3), np.empty(3), np.empty((3, 3))
    A, V, N = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 6))
    T, h = np.empty((1, 6)), np.empty((1, 6, 6))
    for i in range(len(J)):
        m = i if par.shape[0] > 1 else 0
        left_cauchy_green(F, i, J[i] ** (-2.0 / 3.0), b)
        eigen(b, A, w, V)
        if len(W) > 0:
            W[i] = 0.0
        for a in range(3):
            tau[a] = 0.0
            for q in range(3):
                H[a, q] = 0.0
            for t in range(6):
                ct, mt = par[m, t], par[m, 6 + t]
                if ct != 0.0:
                    x = w[a] ** (0.5 * mt)
                    tau[a] += ct / mt * (x - 1.0)
                    H[a, a] += ct * x
                    if len(W) > 0:
                        W[i] += ct / (mt * mt) * (x - 1.0)
        if len(W) == 0:
            clear(T[0], h)
            add_spectral(T, h if c.shape[0] > 0 else c, 0, 1.0, w, V, tau, H, N)
            add_deviatoric_stress(s, i, 1.0 / J[i], T[0])
            if c.shape[0] > 0:
                add_deviatoric_tangent(c, i, 1.0 / J[i], T[0], h)


@dataclass(eq=False)
class Ogden(Uncoupled):
    """W~ = sum_i c_i / m_i^2 (l1~^m_i + l2~^m_i + l3~^m_i - 3).

    Ogden, Proc. R. Soc. A 326 (1972) 565, in the parameters of FEBio's User Manual, "Ogden".
    """

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
    parameters = ("c1", "c2", "c3", "c4", "c5", "c6", "m1", "m2", "m3", "m4", "m5", "m6")

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        _run(pts.F, pts.J, self.par(pts), s, wanted(c), np.empty(0))

    def dev_energy(self, pts: Points) -> Floats:
        W = np.empty(pts.n)
        _run(pts.F, pts.J, self.par(pts), W.reshape(-1, 1), wanted(None), W)
        return W


register(Ogden, "Ogden")
