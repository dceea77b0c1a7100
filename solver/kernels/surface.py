"""Integrals over facets: normal loads, tractions, fluid flow, and what they add to the tangent.

Arrays: x, v (node, 3) positions and velocities; conn (f, n) nodes of the facets; N (g, n), dN (g, n, 2)
and w (g,) of the facet's rule; values at points are (1|f g, ...). With the tangents a_r, a_s of the
facet, a = a_r x a_s is its area vector per unit natural area. Element matrices are -d(force)/d(dof),
component-major: row i n + a is component i of local node a, the pressure being component 3.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel


@kernel
def _tangents(x, nodes, dN, c):
    """c (9,): a_r, a_s and the area vector a = a_r x a_s at one point."""
    for i in range(6):
        c[i] = 0.0
    for b in range(len(nodes)):
        m = nodes[b]
        r, s = dN[b, 0], dN[b, 1]
        for i in range(3):
            c[i] += x[m, i] * r
            c[3 + i] += x[m, i] * s
    c[6] = c[1] * c[5] - c[2] * c[4]
    c[7] = c[2] * c[3] - c[0] * c[5]
    c[8] = c[0] * c[4] - c[1] * c[3]


@kernel
def _norm(c):
    """|a|."""
    return math.sqrt(c[6] * c[6] + c[7] * c[7] + c[8] * c[8])


@kernel
def areas(x, conn, dN, w, A):
    """A (f,): areas of the facets."""
    c = np.empty(9)
    for e in range(conn.shape[0]):
        A[e] = 0.0
        for g in range(len(w)):
            _tangents(x, conn[e], dN[g], c)
            A[e] += _norm(c) * w[g]


@kernel
def normals(x, conn, dN, out):
    """out (f, 3): unit normals at the one point whose derivatives are dN (n, 2)."""
    c = np.empty(9)
    for e in range(conn.shape[0]):
        _tangents(x, conn[e], dN, c)
        h = _norm(c)
        for i in range(3):
            out[e, i] = c[6 + i] / h


@kernel
def normal_force(x, conn, N, dN, w, P, f):
    """f (f, n, 3) += int N P a: a traction P along the normal."""
    c = np.empty(9)
    ng = len(w)
    for e in range(conn.shape[0]):
        for g in range(ng):
            _tangents(x, conn[e], dN[g], c)
            p = P[e * ng + g if len(P) > 1 else 0] * w[g]
            for a in range(conn.shape[1]):
                h = N[g, a] * p
                for i in range(3):
                    f[e, a, i] += h * c[6 + i]


@kernel
def traction_force(x, conn, N, dN, w, T, f):
    """f (f, n, 3) += int N T |a|: a traction T (1|f g, 3) per area of the positions x."""
    c = np.empty(9)
    ng = len(w)
    for e in range(conn.shape[0]):
        for g in range(ng):
            _tangents(x, conn[e], dN[g], c)
            t = T[e * ng + g if T.shape[0] > 1 else 0]
            h = _norm(c) * w[g]
            for a in range(conn.shape[1]):
                for i in range(3):
                    f[e, a, i] += N[g, a] * h * t[i]


@kernel
def flow(x, v, conn, N, dN, w, q, mixture, f):
    """f (f, n) += int N (q |a| - mixture v . a): volume rate into the body."""
    c = np.empty(9)
    ng = len(w)
    for e in range(conn.shape[0]):
        for g in range(ng):
            _tangents(x, conn[e], dN[g], c)
            rate = q[e * ng + g if len(q) > 1 else 0] * _norm(c)
            if mixture:
                for b in range(conn.shape[1]):
                    m = conn[e, b]
                    rate -= N[g, b] * (v[m, 0] * c[6] + v[m, 1] * c[7] + v[m, 2] * c[8])
            for a in range(conn.shape[1]):
                f[e, a] += N[g, a] * rate * w[g]


@kernel
def _skew(M, n, a, b, x, y, z):
    """Add the matrix of the cross product with (x, y, z) to block a, b."""
    M[a, n + b] -= z
    M[a, 2 * n + b] += y
    M[n + a, b] += z
    M[n + a, 2 * n + b] -= x
    M[2 * n + a, b] -= y
    M[2 * n + a, n + b] += x


@kernel
def normal_stiffness(x, conn, N, dN, w, P, symmetric, K):
    """K (f, >= 3n, >= 3n) += -d/dx int N P a.

    ``symmetric`` takes the symmetric part, to which the matrices of a closed surface under uniform P sum
    (FEBio Theory Manual, "Pressure loads").
    """
    n, ng = conn.shape[1], len(w)
    c = np.empty(9)
    z = np.empty(3)
    for e in range(conn.shape[0]):
        for g in range(ng):
            _tangents(x, conn[e], dN[g], c)
            p = P[e * ng + g if len(P) > 1 else 0] * w[g]
            for a in range(n):
                for b in range(n):
                    r, s = N[g, a] * dN[g, b, 0], N[g, a] * dN[g, b, 1]
                    if symmetric:
                        r = 0.5 * (r - N[g, b] * dN[g, a, 0])
                        s = 0.5 * (s - N[g, b] * dN[g, a, 1])
                    for i in range(3):
                        z[i] = p * (c[3 + i] * r - c[i] * s)
                    _skew(K[e], n, a, b, z[0], z[1], z[2])


@kernel
def pressure_columns(x, conn, N, dN, w, k, K):
    """K (f, 4n, 4n) += k int N_a N_b a in the rows of the displacements, columns of the pressure."""
    n = conn.shape[1]
    c = np.empty(9)
    for e in range(conn.shape[0]):
        for g in range(len(w)):
            _tangents(x, conn[e], dN[g], c)
            for i in range(3):
                h = k * c[6 + i] * w[g]
                for a in range(n):
                    for b in range(n):
                        K[e, i * n + a, 3 * n + b] += h * N[g, a] * N[g, b]


@kernel
def flow_stiffness(x, v, conn, N, dN, w, q, mixture, follower, dt, K):
    """K (f, 4n, 4n) += -dt d/du int N (q |a| - mixture v . a) with dv/du = 1/dt, rows of the pressure.

    ``follower`` False leaves out the change of a (flow per reference area).
    """
    n, ng = conn.shape[1], len(w)
    c = np.empty(9)
    d = np.empty(3)
    for e in range(conn.shape[0]):
        for g in range(ng):
            _tangents(x, conn[e], dN[g], c)
            k = q[e * ng + g if len(q) > 1 else 0] / _norm(c)
            for i in range(3):
                d[i] = k * c[6 + i]
                if mixture:
                    for b in range(n):
                        d[i] -= N[g, b] * v[conn[e, b], i]
            for b in range(n):
                # d . (d a) = (z x d) . du with z = a_s dN_r - a_r dN_s
                u0 = u1 = u2 = 0.0
                if follower:
                    z0 = c[3] * dN[g, b, 0] - c[0] * dN[g, b, 1]
                    z1 = c[4] * dN[g, b, 0] - c[1] * dN[g, b, 1]
                    z2 = c[5] * dN[g, b, 0] - c[2] * dN[g, b, 1]
                    u0, u1, u2 = z1 * d[2] - z2 * d[1], z2 * d[0] - z0 * d[2], z0 * d[1] - z1 * d[0]
                    u0, u1, u2 = u0 * dt, u1 * dt, u2 * dt
                if mixture:
                    u0 -= N[g, b] * c[6]
                    u1 -= N[g, b] * c[7]
                    u2 -= N[g, b] * c[8]
                for a in range(n):
                    h = N[g, a] * w[g]
                    K[e, 3 * n + a, b] -= h * u0
                    K[e, 3 * n + a, n + b] -= h * u1
                    K[e, 3 * n + a, 2 * n + b] -= h * u2


@kernel
def add_vectors(conn, f, R):
    """R (node, 3) += facet vectors f (f, n, 3)."""
    for e in range(conn.shape[0]):
        for a in range(conn.shape[1]):
            for i in range(3):
                R[conn[e, a], i] += f[e, a, i]


@kernel
def add_scalars(conn, f, R):
    """R (node,) += facet scalars f (f, n)."""
    for e in range(conn.shape[0]):
        for a in range(conn.shape[1]):
            R[conn[e, a]] += f[e, a]
