"""Contact along the normal of the secondary surface at the closest point, per reference area of the primary one.

For what the arrays are see :mod:`.contact`. With n the secondary facet's normal at the closest point q,
g = -n . (x - q) the penetration and p = max(L + eps g, 0) the pressure, a point's force on the primary surface is
p A n. The tangent is that of Laursen and Simo, Int J Numer Meth Engng 36 (1993) 3451; ``k`` multiplies its terms in
the pressure. Source: FEBio Theory Manual, "Contact: linearization of the contact integral".
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from . import contact, facets


@kernel
def metric(T, x, nodes, n, r, s, normal, Gm, C, t, out):
    """out (6,): products M11, M12, M22 of a facet's tangents, and its curvatures n . x_rr, n . x_rs, n . x_ss."""
    facets.slopes(T, n, r, s, Gm)
    facets.curvatures(T, n, r, s, C)
    facets.tangents(x, nodes, n, Gm, t)
    out[0], out[1], out[2] = facets.dot(t[0], t[0]), facets.dot(t[0], t[1]), facets.dot(t[1], t[1])
    out[3] = out[4] = out[5] = 0.0
    for a in range(n):
        h = facets.dot(normal, x[nodes[a]])
        for c in range(3):
            out[3 + c] += C[a, c] * h


@kernel
def vectors(W, ns, nm, Gm, t, n, g, m, V):
    """V (5, d): the vectors N, N1, N2, D1, D2 of a point; m (6,) as :func:`metric` gives it.

    N . du is minus the change of the gap, D1 . du and D2 . du those of the coordinates r and s of the closest point.
    """
    a, b, c = m[0] + g * m[3], m[1] + g * m[4], m[2] + g * m[5]
    det = a * c - b * b
    for k in range(ns + nm):
        gr = -Gm[k - ns, 0] if k >= ns else 0.0
        gs = -Gm[k - ns, 1] if k >= ns else 0.0
        for i in range(3):
            j = 3 * k + i
            V[0, j], V[1, j], V[2, j] = W[k] * n[i], gr * n[i], gs * n[i]
            u, v = W[k] * t[0, i] + g * V[1, j], W[k] * t[1, i] + g * V[2, j]
            V[3, j], V[4, j] = (c * u - b * v) / det, (a * v - b * u) / det


@kernel
def _turn(V, d, g, m, f, K):
    """K += f times the second derivative of the gap."""
    det = m[0] * m[2] - m[1] * m[1]
    m11, m12, m22 = m[2] / det, -m[1] / det, m[0] / det
    k = m[4]
    for i in range(d):
        b1, b2 = V[1, i] - k * V[4, i], V[2, i] - k * V[3, i]
        for j in range(d):
            c1, c2 = V[1, j] - k * V[4, j], V[2, j] - k * V[3, j]
            h = g * (m11 * b1 * c1 + m12 * (b1 * c2 + b2 * c1) + m22 * b2 * c2)
            h -= V[3, i] * V[1, j] + V[4, i] * V[2, j] + V[1, i] * V[3, j] + V[2, i] * V[4, j]
            h += k * (V[3, i] * V[4, j] + V[4, i] * V[3, j])
            K[i, j] += f * h


@kernel
def stiffness(T, x, conn, partner, rs, rows, ns, nm, N, M, normals, gap, stiff, force, k, K):
    """K (rows, d, d) += tangent; stiff (q,): A eps where in contact, force (q,): A p."""
    W, V, m = np.empty(18), np.empty((5, 54)), np.empty(6)
    Gm, C, t = np.empty((9, 2)), np.empty((9, 3)), np.empty((3, 3))
    d = 3 * (ns + nm)
    for j in range(len(rows)):
        q = rows[j]
        contact.weights(N[q], M[q], ns, nm, W)
        metric(T, x, conn[partner[q]], nm, rs[q, 0], rs[q, 1], normals[q], Gm, C, t, m)
        vectors(W, ns, nm, Gm, t, normals[q], gap[q], m, V)
        for a in range(d):
            for b in range(d):
                K[j, a, b] += stiff[q] * V[0, a] * V[0, b]
        if k * force[q] != 0.0:
            _turn(V, d, gap[q], m, k * force[q], K[j])
