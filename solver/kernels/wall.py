"""Arterial walls of two families of dispersed fibers in a matrix, point by point."""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from .fibers import add_sums
from .tensors import clear, left_cauchy_green, trace


@kernel
def wall(F, J, par, A, iso, s, c):
    """Add stress and tangent of :class:`..solids.holzapfel_gasser_ogden._Wall`: matrix and fibers, of F~ if ``iso``.

    par (1|n, 5): c, k1, k2, kappa, gamma (degrees); A (1|n, 3, 3): material axes in columns, fibers at plus and minus
    gamma from the first towards the second. Fibers at rest count as tense, so that the tangent is that of the loading
    to come.
    """
    b, g, T, h = np.empty(6), np.empty(6), np.empty(6), np.empty((1, 6, 6))
    P, Q = np.array([0, 1, 2, 0, 1, 0]), np.array([0, 1, 2, 1, 2, 2])
    a = np.empty(3)
    for i in range(len(J)):
        m, d = i if par.shape[0] > 1 else 0, i if A.shape[0] > 1 else 0
        k1, k2, kappa, gamma = par[m, 1], par[m, 2], par[m, 3], math.radians(par[m, 4])
        scale = J[i] ** (-2.0 / 3.0) if iso else 1.0
        left_cauchy_green(F, i, scale, b)
        clear(T, h)
        for p in range(6):
            T[p] = par[m, 0] * b[p]
        for family in range(2):
            x, y = math.cos(gamma), math.sin(gamma) if family == 0 else -math.sin(gamma)
            for p in range(3):
                a[p] = 0.0
                for q in range(3):
                    a[p] += F[i, p, q] * (A[d, q, 0] * x + A[d, q, 1] * y)
            I4 = scale * (a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
            E = kappa * (trace(b) - 3.0) + (1.0 - 3.0 * kappa) * (I4 - 1.0)
            if E < 0.0:
                continue
            for p in range(6):
                g[p] = kappa * b[p] + (1.0 - 3.0 * kappa) * scale * a[P[p]] * a[Q[p]]
            grown = math.exp(k2 * E * E)
            w = 4.0 * k1 * (1.0 + 2.0 * k2 * E * E) * grown
            for p in range(6):
                T[p] += 2.0 * k1 * E * grown * g[p]
                if c.shape[0] > 0:
                    for q in range(6):
                        h[0, p, q] += w * g[p] * g[q]
        add_sums(s, c, i, J[i], T, h, iso)
