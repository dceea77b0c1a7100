"""Contact along the normal of the primary surface, per its current area: tractions and tangents.

For what the arrays are see :mod:`.contact`. With n the normal of the primary facet, g = n . (x - q) the penetration
and p = L + eps g the pressure, a point's force on the primary surface is -p n |a|. Its change is that of Bonet and
Wood's pressure loads on the primary facet, and of q, which slides over the secondary facet; ``k`` multiplies the
terms that vanish with the gap. Source: Ateshian et al., J. Biomech. Eng. 132 (2010) 061006, and the FEBio Theory
Manual, "Sliding elastic".
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from . import contact, facets

ROUNDING = 16 * np.finfo(float).eps
TOUCH = 1e-30  # a penetration that pushes with nothing, and yet counts


@kernel
def gaps(points, normals, place, partner, offset, radius, tension, eps, L, gap):
    """Penetrations (q,); points too deep, or apart without tension, lose their partner. L (q,) multipliers.

    Points that touch to rounding have no force, and a tangent: Newton's first step knows of the other surface. In FEBio
    half of them do, at random.
    """
    for q in range(len(partner)):
        gap[q] = 0.0
        if partner[q] >= 0:
            g, size = offset, abs(offset)
            for i in range(3):
                g += normals[q, i] * (points[q, i] - place[q, i])
                size += abs(normals[q, i]) * (abs(points[q, i]) + abs(place[q, i]))
            if L[q] == 0.0 and abs(g) <= ROUNDING * size:
                g = TOUCH
            gap[q] = g
            apart = L[q] + eps[q] * g < 0.0
            if g > radius or (not tension and apart):
                partner[q] = -1
        if partner[q] < 0:
            gap[q] = L[q] = 0.0


@kernel
def bases(x, T, sconn, mconn, ns, nm, G, r, s, k, Gm, gs, gm, cs, cm, a):
    """Tangents gs, gm (3, 3) of both facets and bases dual to them: cs, cm (3, 3), cm[2] the unit normal that the
    force on the secondary facet turns about. Where k counts, each is dual to the other facet's tangents: cs to gm, cm
    to gs; a (2, 2) inverts gs . gm. Gm (9, 2): derivatives on the secondary facet."""
    facets.tangents(x, sconn, ns, G, gs)
    facets.slopes(T, nm, r, s, Gm)
    facets.tangents(x, mconn, nm, Gm, gm)
    _inverse(gs, gm, a)
    if k == 0.0:
        _dual(gm, cm)
        _dual(gs, cs)
        h = facets.length(gm[2])
        for i in range(3):
            cm[2, i] = gm[2, i] / h
        return
    h = facets.length(gs[2])
    for i in range(3):
        cm[0, i] = gs[0, i] * a[0, 0] + gs[1, i] * a[0, 1]
        cm[1, i] = gs[0, i] * a[1, 0] + gs[1, i] * a[1, 1]
        cs[0, i] = gm[0, i] * a[0, 0] + gm[1, i] * a[1, 0]
        cs[1, i] = gm[0, i] * a[0, 1] + gm[1, i] * a[1, 1]
        cm[2, i] = -gs[2, i] / h


@kernel
def _inverse(u, v, a):
    """a (2, 2) = inverse of u_i . v_j."""
    p, q = facets.dot(u[0], v[0]), facets.dot(u[0], v[1])
    r, s = facets.dot(u[1], v[0]), facets.dot(u[1], v[1])
    det = p * s - q * r
    a[0, 0], a[0, 1], a[1, 0], a[1, 1] = s / det, -q / det, -r / det, p / det


@kernel
def _dual(g, c):
    """c[:2] dual to the tangents g."""
    p, q, s = facets.dot(g[0], g[0]), facets.dot(g[0], g[1]), facets.dot(g[1], g[1])
    det = p * s - q * q
    for i in range(3):
        c[0, i] = (s * g[0, i] - q * g[1, i]) / det
        c[1, i] = (p * g[1, i] - q * g[0, i]) / det


@kernel
def stiffness(T, x, sconn, facet, mconn, partner, rs, rows, ns, nm, N, G, M, weight, normals, gap, eps, p, k, K):
    """K (rows, d, d) += tangent of frictionless points with penalty eps (q,) and pressure p (q,)."""
    W, Gm, a, v = np.empty(18), np.empty((9, 2)), np.empty((2, 2)), np.empty(3)
    gs, gm, cs, cm = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for j in range(len(rows)):
        q = rows[j]
        n = normals[q]
        contact.weights(N[q], M[q], ns, nm, W)
        bases(
            x, T, sconn[facet[q]], mconn[partner[q]], ns, nm, G[q], rs[q, 0], rs[q, 1], k, Gm, gs, gm, cs, cm, a
        )  # fmt: skip
        area = facets.length(gs[2])
        c0, c1 = k * facets.dot(cs[0], n), k * facets.dot(cs[1], n)
        for i in range(3):
            v[i] = n[i] - c0 * gs[0, i] - c1 * gs[1, i]
        f, t = eps[q] * area * weight[q], -p[q] * area * weight[q]
        for b in range(ns + nm):
            for d in range(ns + nm):
                for i in range(3):
                    h = f * W[b] * W[d] * n[i]
                    for l in range(3):
                        K[j, 3 * b + i, 3 * d + l] += h * v[l]
        _turn_primary(K[j], ns, nm, W, G[q], gs, cs, n, k, t, area)
        _turn_secondary(K[j], ns, nm, W, G[q], Gm, cm, n, a, -gap[q] * k, t)


@kernel
def _turn_primary(K, ns, nm, W, G, gs, cs, n, k, t, area):
    """What the turning of the primary facet's area vector adds, for a traction t n per point."""
    for d in range(ns):
        m = 0.0
        for i in range(3):
            m += (cs[0, i] * G[d, 0] + cs[1, i] * G[d, 1]) * n[i]
        m *= k * t
        z0 = t / area * (gs[1, 0] * G[d, 0] - gs[0, 0] * G[d, 1])
        z1 = t / area * (gs[1, 1] * G[d, 0] - gs[0, 1] * G[d, 1])
        z2 = t / area * (gs[1, 2] * G[d, 0] - gs[0, 2] * G[d, 1])
        for b in range(ns + nm):
            w = W[b]
            for i in range(3):
                for l in range(3):
                    K[3 * b + i, 3 * d + l] += w * m * n[i] * n[l]
            K[3 * b, 3 * d + 1] -= w * z2
            K[3 * b, 3 * d + 2] += w * z1
            K[3 * b + 1, 3 * d] += w * z2
            K[3 * b + 1, 3 * d + 2] -= w * z0
            K[3 * b + 2, 3 * d] -= w * z1
            K[3 * b + 2, 3 * d + 1] += w * z0


@kernel
def _turn_secondary(K, ns, nm, W, G, Gm, cm, n, a, g, t):
    """What the sliding of the point over the secondary facet adds."""
    for b in range(nm):
        r = 3 * (ns + b)
        for l in range(3):
            m = t * (cm[0, l] * Gm[b, 0] + cm[1, l] * Gm[b, 1])
            for i in range(3):
                for d in range(ns + nm):
                    K[r + i, 3 * d + l] -= m * W[d] * cm[2, i]
        if g == 0.0:
            continue
        for d in range(ns):
            h = a[0, 0] * Gm[b, 0] * G[d, 0] + a[0, 1] * Gm[b, 0] * G[d, 1]
            h = t * g * (h + a[1, 0] * Gm[b, 1] * G[d, 0] + a[1, 1] * Gm[b, 1] * G[d, 1])
            for i in range(3):
                for l in range(3):
                    K[r + i, 3 * d + l] -= h * n[i] * n[l]


