"""Fluid that passes between biphasic surfaces in contact: a flow wn = L + eps (p1 - p2) per current area.

For what the arrays are see :mod:`.contact`. Matrices K (rows, 4 n, 4 n) have the displacements node by node, then
the pressures; their rows of the pressures are filled here. Sources: Ateshian et al., J. Biomech. Eng. 132 (2010)
061006; FEBio Theory Manual, "Biphasic contact".
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from . import contact, facets, sliding_elastic


@kernel
def spread(sconn, scount, facet, N, mconn, mcount, partner, M, f, R):
    """R (node,) += W f, f (q,) being what each point gives."""
    for q in range(len(partner)):
        e = partner[q]
        if e < 0 or f[q] == 0.0:
            continue
        s = facet[q]
        for a in range(scount[s]):
            R[sconn[s, a]] += N[q, a] * f[q]
        for a in range(mcount[e]):
            R[mconn[e, a]] -= M[q, a] * f[q]


@kernel
def _area(gs, G, ns, f, W, m, K):
    """What the change of the primary facet's area adds, for a flow f per natural area over its own."""
    for d in range(ns):
        v0 = gs[1, 0] * G[d, 0] - gs[0, 0] * G[d, 1]
        v1 = gs[1, 1] * G[d, 0] - gs[0, 1] * G[d, 1]
        v2 = gs[1, 2] * G[d, 0] - gs[0, 2] * G[d, 1]
        n0, n1, n2 = gs[2, 0], gs[2, 1], gs[2, 2]
        for b in range(m):
            K[3 * m + b, 3 * d] += f * W[b] * (n1 * v2 - n2 * v1)
            K[3 * m + b, 3 * d + 1] += f * W[b] * (n2 * v0 - n0 * v2)
            K[3 * m + b, 3 * d + 2] += f * W[b] * (n0 * v1 - n1 * v0)


@kernel
def tied(x, sconn, facet, rows, ns, nm, N, G, M, weight, wn, eps, dt, K):
    """Rows of the pressures where the partners stay."""
    W, gs, m = np.empty(18), np.empty((3, 3)), ns + nm
    for j in range(len(rows)):
        q = rows[j]
        contact.weights(N[q], M[q], ns, nm, W)
        facets.tangents(x, sconn[facet[q]], ns, G[q], gs)
        area = facets.length(gs[2])
        _area(gs, G[q], ns, dt * weight[q] * wn[q] / area, W, m, K[j])
        for a in range(m):
            for b in range(m):
                K[j, 3 * m + a, 3 * m + b] -= dt * weight[q] * area * eps[q] * W[a] * W[b]


@kernel
def sliding(
    T, x, p, sconn, facet, mconn, partner, rs, rows, ns, nm, N, G, M, weight, normals, gap, wn, eps, dt, K
):  # fmt: skip
    """Rows of the pressures where the partners slide; p (node,) pressures."""
    W, Gm, a, m = np.empty(18), np.empty((9, 2)), np.empty((2, 2)), ns + nm
    gs, gm, cs, cm = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for j in range(len(rows)):
        q = rows[j]
        n, mn = normals[q], mconn[partner[q]]
        contact.weights(N[q], M[q], ns, nm, W)
        sliding_elastic.bases(
            x, T, sconn[facet[q]], mn, ns, nm, G[q], rs[q, 0], rs[q, 1], 1.0, Gm, gs, gm, cs, cm, a
        )  # fmt: skip
        area = facets.length(gs[2])
        f, h = dt * weight[q] * area * wn[q], dt * weight[q] * area * eps[q]
        _area(gs, G[q], ns, f / (area * area), W, m, K[j])
        pr = ps = 0.0
        for b in range(nm):
            pr += p[mn[b]] * Gm[b, 0]
            ps += p[mn[b]] * Gm[b, 1]
        for b in range(m):
            for d in range(m):
                K[j, 3 * m + b, 3 * m + d] -= h * W[b] * W[d]
                for i in range(3):
                    K[j, 3 * m + b, 3 * d + i] += h * W[b] * W[d] * (cm[0, i] * pr + cm[1, i] * ps)
        for b in range(nm):
            for i in range(3):
                u = f * (cm[0, i] * Gm[b, 0] + cm[1, i] * Gm[b, 1])
                for d in range(m):
                    K[j, 3 * m + ns + b, 3 * d + i] += u * W[d]
        for d in range(ns):
            r, s = a[0, 0] * G[q, d, 0] + a[0, 1] * G[q, d, 1], a[1, 0] * G[q, d, 0] + a[1, 1] * G[q, d, 1]
            c = -gap[q] * (pr * r + ps * s)
            for i in range(3):
                for b in range(m):
                    K[j, 3 * m + b, 3 * d + i] -= h * W[b] * c * n[i]
                for b in range(nm):
                    u = -gap[q] * (Gm[b, 0] * r + Gm[b, 1] * s)
                    K[j, 3 * m + ns + b, 3 * d + i] -= f * u * n[i]


@kernel
def relief(rows, ns, nm, N, M, drag, K):
    """What the primary's pressures add to the rows of displacements by relieving friction; drag (q, 3): force per
    pressure of a point that slips, against it."""
    W, m = np.empty(18), ns + nm
    for j in range(len(rows)):
        q = rows[j]
        contact.weights(N[q], M[q], ns, nm, W)
        for b in range(m):
            for d in range(ns):
                for i in range(3):
                    K[j, 3 * b + i, 3 * m + d] -= W[b] * W[d] * drag[q, i]
