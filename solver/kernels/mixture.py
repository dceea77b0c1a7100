"""Loops over elements of a mixture: shape functions with spatial gradients, and nodal forces into the residual."""

from __future__ import annotations

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
