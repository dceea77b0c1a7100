"""Friction of nodes that slide on facets, in the natural coordinates of the facet they touch.

T_a = L_a + eps_f M_ab (xi_b - xi0_b), M the metric of the facet in the reference, xi and xi0 the present and the
first place of the node on it; |T| = sqrt(T . M^-1 . T) is at most mu p. The force on the node is minus A T_a D_a with
D_a . du the change of xi_a. Source: Laursen and Simo, Int J Numer Meth Engng 36 (1993) 3451.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from . import closest, contact, facets, sliding


@kernel
def metrics(T, X, conn, count, partner, rs, out):
    """out (q, 3): M11, M12, M22 of the partners at rs, in the reference."""
    G, t = np.empty((9, 2)), np.empty((3, 3))
    for q in range(len(partner)):
        e = partner[q]
        if e >= 0:
            facets.slopes(T, count[e], rs[q, 0], rs[q, 1], G)
            facets.tangents(X, conn[e], count[e], G, t)
            out[q, 0], out[q, 1] = facets.dot(t[0], t[0]), facets.dot(t[0], t[1])
            out[q, 2] = facets.dot(t[1], t[1])


@kernel
def size(m, a, b):
    """sqrt(T . M^-1 . T)."""
    return math.sqrt(max((m[2] * a * a - 2.0 * m[1] * a * b + m[0] * b * b) / (m[0] * m[2] - m[1] * m[1]), 0.0))


@kernel
def trial(m, L, rs, rs0, eps, most, out):
    """out (2,): the tangential traction, its size at most ``most``; returns its size before."""
    u, v = rs[0] - rs0[0], rs[1] - rs0[1]
    out[0], out[1] = L[0] + eps * (m[0] * u + m[1] * v), L[1] + eps * (m[1] * u + m[2] * v)
    h = size(m, out[0], out[1])
    if h > most:
        out[0] *= most / h
        out[1] *= most / h
    return h


@kernel
def trials(partner, m, L, rs, rs0, eps, most, out):
    """:func:`trial` of all nodes that have a partner; most (q,)."""
    for q in range(len(partner)):
        if partner[q] >= 0:
            trial(m[q], L[q], rs[q], rs0[q], eps, most[q], out[q])


@kernel
def carry(T, x, X, conn, count, before, partner, rs, rs0, L):
    """Carry first places and multipliers over to new partners."""
    H, G, C, w = np.empty(9), np.empty((9, 2)), np.empty((9, 3)), np.empty((10, 4))
    at, q3, t, v = np.empty(3), np.empty(3), np.empty((3, 3)), np.empty(3)
    for q in range(len(partner)):
        o, e = before[q], partner[q]
        if o < 0 or e < 0 or o == e:
            continue
        facets.slopes(T, count[o], rs0[q, 0], rs0[q, 1], G)
        facets.tangents(X, conn[o], count[o], G, t)
        a, b, c = facets.dot(t[0], t[0]), facets.dot(t[0], t[1]), facets.dot(t[1], t[1])
        det = a * c - b * b
        u0, u1 = (c * L[q, 0] - b * L[q, 1]) / det, (a * L[q, 1] - b * L[q, 0]) / det
        for i in range(3):
            v[i] = u0 * t[0, i] + u1 * t[1, i]
        facets.shape(T, count[o], rs0[q, 0], rs0[q, 1], H)
        facets.place(x, conn[o], count[o], H, at)
        closest.project(T, x, conn[e], count[e], at, H, G, C, w, rs0[q], q3)
        facets.slopes(T, count[e], rs[q, 0], rs[q, 1], G)
        facets.tangents(X, conn[e], count[e], G, t)
        L[q, 0], L[q, 1] = facets.dot(v, t[0]), facets.dot(v, t[1])


@kernel
def force(T, x, nodes, conn, count, partner, rs, N, M, normals, gap, traction, area, R):
    """R (node, >= 3) -= A T_a D_a."""
    W, V, m = np.empty(18), np.empty((5, 54)), np.empty(6)
    Gm, C, t = np.empty((9, 2)), np.empty((9, 3)), np.empty((3, 3))
    for q in range(len(partner)):
        e = partner[q]
        if e < 0 or (traction[q, 0] == 0.0 and traction[q, 1] == 0.0):
            continue
        nm = count[e]
        contact.weights(N[q], M[q], 1, nm, W)
        sliding.metric(T, x, conn[e], nm, rs[q, 0], rs[q, 1], normals[q], Gm, C, t, m)
        sliding.vectors(W, 1, nm, Gm, t, normals[q], gap[q], m, V)
        for k in range(1 + nm):
            node = nodes[q] if k == 0 else conn[e, k - 1]
            for i in range(3):
                f = traction[q, 0] * V[3, 3 * k + i] + traction[q, 1] * V[4, 3 * k + i]
                R[node, i] -= area[q] * f


@kernel
def stick(T, x, conn, partner, rs, rows, nm, N, M, normals, gap, metric, k, K):
    """K (rows, d, d) += k D_a M_ab D_b for nodes that stick; k (q,) area times penalty."""
    W, V, m = np.empty(18), np.empty((5, 54)), np.empty(6)
    Gm, C, t = np.empty((9, 2)), np.empty((9, 3)), np.empty((3, 3))
    d = 3 * (1 + nm)
    for j in range(len(rows)):
        q = rows[j]
        contact.weights(N[q], M[q], 1, nm, W)
        sliding.metric(T, x, conn[partner[q]], nm, rs[q, 0], rs[q, 1], normals[q], Gm, C, t, m)
        sliding.vectors(W, 1, nm, Gm, t, normals[q], gap[q], m, V)
        a, b, c = metric[q, 0], metric[q, 1], metric[q, 2]
        for i in range(d):
            for l in range(d):
                h = V[3, i] * (a * V[3, l] + b * V[4, l]) + V[4, i] * (b * V[3, l] + c * V[4, l])
                K[j, i, l] += k[q] * h
