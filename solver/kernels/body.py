"""Integrals of body forces over elements.

m (e, g) is the mass at the points (density times weight times Jacobian), a (1|e g, 3) the acceleration.
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from .solid import gradients


@kernel
def force(conn, N, m, a, R):
    """R (node, 3) += sum_g N m a."""
    ng = N.shape[0]
    for e in range(conn.shape[0]):
        for g in range(ng):
            r = e * ng + g if a.shape[0] > 1 else 0
            for b in range(conn.shape[1]):
                h = N[g, b] * m[e, g]
                for i in range(3):
                    R[conn[e, b], i] += h * a[r, i]


@kernel
def stiffness(N, m, D, K):
    """K (e, 3n, 3n) -= sum_g N_a N_b m D with D (1|e g, 3, 3) = da/du, component-major."""
    ng, n = N.shape
    for e in range(K.shape[0]):
        for g in range(ng):
            r = e * ng + g if D.shape[0] > 1 else 0
            for i in range(3):
                for j in range(3):
                    d = D[r, i, j] * m[e, g]
                    if d != 0.0:
                        for a in range(n):
                            for b in range(n):
                                K[e, i * n + a, j * n + b] -= d * N[g, a] * N[g, b]


@kernel
def swelling(N, dN, iJ0, F, J, m, a, K):
    """K (e, 3n, 3n) -= sum_g N_a m a (grad N_b): a mass that grows with volume, dm = m div du."""
    ng, n = N.shape
    G = np.empty((3, n))
    for e in range(K.shape[0]):
        for g in range(ng):
            r = e * ng + g if a.shape[0] > 1 else 0
            gradients(F[e, g], J[e, g], iJ0[e, g], dN[g], G)
            for i in range(3):
                h = m[e, g] * a[r, i]
                if h != 0.0:
                    for j in range(3):
                        for p in range(n):
                            for q in range(n):
                                K[e, i * n + p, j * n + q] -= h * N[g, p] * G[j, q]
