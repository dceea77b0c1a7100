"""Loops over elements of a mixture: shape functions with spatial gradients, and nodal forces into the residual."""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from .solid import inverse_map


@kernel
def shapes(lo, hi, N, dN, iJ0, F, J, B):
    """B[e - lo, g, :, a] = N_a, grad N_a at the points of elements lo:hi."""
    for e in range(lo, hi):
        for g in range(dN.shape[0]):
            m00, m01, m02, m10, m11, m12, m20, m21, m22 = inverse_map(F[e, g], J[e, g], iJ0[e, g])
            b = B[e - lo, g]
            for a in range(dN.shape[1]):
                x, y, z = dN[g, a, 0], dN[g, a, 1], dN[g, a, 2]
                b[0, a] = N[g, a]
                b[1, a] = x * m00 + y * m10 + z * m20
                b[2, a] = x * m01 + y * m11 + z * m21
                b[3, a] = x * m02 + y * m12 + z * m22


@kernel
def subtract(lo, hi, conn, columns, f, R):
    """R[conn, columns] -= f (hi - lo, columns, n)."""
    for e in range(lo, hi):
        for c in range(len(columns)):
            for a in range(conn.shape[1]):
                R[conn[e, a], columns[c]] -= f[e - lo, c, a]


@kernel
def matrices(B, weight, A, K):
    """K (e, C n, C n), component-major: sum over points of weight B . A . B; B (e, g, 4, n), A (e g, 4, C, C, 4).

    The first three components are displacements, which enter by their gradients alone.
    """
    ng, n, C = B.shape[1], B.shape[3], A.shape[2]
    X = np.zeros((4, C * n))
    for e in range(B.shape[0]):
        M = K[e]
        M[:] = 0.0
        for g in range(ng):
            b, T, w = B[e, g], A[e * ng + g], weight[e, g]
            for r in range(C):
                for a in range(1 if r < 3 else 0, 4):
                    for s in range(C):
                        t = T[a, r, s]
                        t0 = 0.0 if s < 3 else t[0]
                        for j in range(n):
                            X[a, s * n + j] = t0 * b[0, j] + t[1] * b[1, j] + t[2] * b[2, j] + t[3] * b[3, j]
                for i in range(n):
                    f0, f1, f2, f3, row = w * b[0, i], w * b[1, i], w * b[2, i], w * b[3, i], M[r * n + i]
                    if r < 3:
                        for j in range(C * n):
                            row[j] += f1 * X[1, j] + f2 * X[2, j] + f3 * X[3, j]
                    else:
                        for j in range(C * n):
                            row[j] += f0 * X[0, j] + f1 * X[1, j] + f2 * X[2, j] + f3 * X[3, j]
