"""What all contacts share: where the partners of points are, forces on both surfaces, and penalty stiffness.

Points (q,) lie on primary facets ``facet`` (nodes sconn, scount; shape functions N (q, 9)); partner (q,) is the
secondary facet (nodes mconn, mcount) of each or -1, M (q, 9) the shape functions at its point. A point acts on the
nodes of both facets with weights W = (N, -M). Element matrices K (rows, d, d) are -d(force)/d(dof), node by node.
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from . import facets


@kernel
def partners(T, x, conn, count, partner, rs, M, place):
    """M: shape functions of the partners at rs (q, 2); place (q, 3): positions there."""
    for q in range(len(partner)):
        e = partner[q]
        if e >= 0:
            facets.shape(T, count[e], rs[q, 0], rs[q, 1], M[q])
            facets.place(x, conn[e], count[e], M[q], place[q])


@kernel
def partner_normals(T, x, conn, count, partner, rs, normals):
    """Unit normals (q, 3) of the partners at rs."""
    G, t = np.empty((9, 2)), np.empty((3, 3))
    for q in range(len(partner)):
        e = partner[q]
        if e >= 0:
            facets.slopes(T, count[e], rs[q, 0], rs[q, 1], G)
            facets.tangents(x, conn[e], count[e], G, t)
            h = facets.length(t[2])
            for i in range(3):
                normals[q, i] = t[2, i] / h


@kernel
def spread(sconn, scount, facet, N, mconn, mcount, partner, M, t, R):
    """R (node, 3) += W t, t (q, 3) being the force of each point on the primary surface."""
    for q in range(len(partner)):
        e = partner[q]
        if e < 0:
            continue
        f = facet[q]
        for a in range(scount[f]):
            for i in range(3):
                R[sconn[f, a], i] += N[q, a] * t[q, i]
        for a in range(mcount[e]):
            for i in range(3):
                R[mconn[e, a], i] -= M[q, a] * t[q, i]


@kernel
def weights(N, M, ns, nm, W):
    """W (>= ns + nm,): the primary's shape functions, then minus the secondary's."""
    for a in range(ns):
        W[a] = N[a]
    for a in range(nm):
        W[ns + a] = -M[a]


@kernel
def penalty_stiffness(rows, ns, nm, N, M, k, K):
    """K += k W x W for each direction alike; k (q,) penalty times area."""
    W = np.empty(18)
    for j in range(len(rows)):
        q = rows[j]
        weights(N[q], M[q], ns, nm, W)
        for a in range(ns + nm):
            for b in range(ns + nm):
                v = k[q] * W[a] * W[b]
                for i in range(3):
                    K[j, 3 * a + i, 3 * b + i] += v


@kernel
def area_stiffness(x, sconn, facet, rows, ns, nm, N, G, M, weight, t, K):
    """K += -W t d|a| for a traction t (q, 3) per current area of the primary facet."""
    W, g, n, c = np.empty(18), np.empty((3, 3)), np.empty(3), np.empty(3)
    for j in range(len(rows)):
        q = rows[j]
        weights(N[q], M[q], ns, nm, W)
        facets.tangents(x, sconn[facet[q]], ns, G[q], g)
        h = facets.length(g[2])
        for i in range(3):
            n[i] = g[2, i] / h
        for b in range(ns):
            # d|a| = n . (dr x g_s + g_r x ds) = -(n x v) . du with v = g_s G_r - g_r G_s
            for i in range(3):
                c[i] = g[1, i] * G[q, b, 0] - g[0, i] * G[q, b, 1]
            v0, v1, v2 = n[1] * c[2] - n[2] * c[1], n[2] * c[0] - n[0] * c[2], n[0] * c[1] - n[1] * c[0]
            for a in range(ns + nm):
                for i in range(3):
                    f = weight[q] * W[a] * t[q, i]
                    K[j, 3 * a + i, 3 * b] += f * v0
                    K[j, 3 * a + i, 3 * b + 1] += f * v1
                    K[j, 3 * a + i, 3 * b + 2] += f * v2
