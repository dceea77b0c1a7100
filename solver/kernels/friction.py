"""Coulomb friction on top of :mod:`.sliding_elastic`: which points stick, tractions, and what slip adds to tangents.

A point that touched the other surface at the start of the step sticks to where it did, with the traction
t = L + eps (x2 - x1), while |t - n (t . n)| < m |t . n|; else it slips with t = -p (n + m s), s the direction of
its slip over the step. m = mu (1 - a f), at least 0, where the fluid bears a share f of the load and ``share`` a of the
area; m = mu without fluid. Source: Zimmerman and Ateshian, J. Biomech. Eng. 140 (2018) 081013; Ateshian, J. Biomech. 42
(2009) 1163; FEBio Theory Manual, "Sliding elastic" and "Sliding biphasic".
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from . import contact, facets, sliding_elastic


@kernel
def _cross(a, b, out):
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@kernel
def slip(x, y, sconn, ns, mconn, nm, N, G, M, n, g, gs, gp, w, dr, m):
    """Slip of a point since the step began, at positions y: its length; w[0] its direction.

    dr (3,): the motion of the point over the other surface; m (3,): the change of the area vector; gs, gp (3, 3):
    tangents now and then, gp being left as their change.
    """
    facets.tangents(x, sconn, ns, G, gs)
    facets.tangents(y, sconn, ns, G, gp)
    for i in range(3):
        gp[0, i], gp[1, i] = gs[0, i] - gp[0, i], gs[1, i] - gp[1, i]
    _cross(gp[0], gs[1], w[1])
    _cross(gs[0], gp[1], w[2])
    for i in range(3):
        m[i] = w[1, i] + w[2, i]
    area, mn = facets.length(gs[2]), facets.dot(m, n)
    for i in range(3):
        dr[i] = -g * (m[i] - mn * n[i]) / area
        for a in range(ns):
            dr[i] += N[a] * (x[sconn[a], i] - y[sconn[a], i])
        for a in range(nm):
            dr[i] -= M[a] * (x[mconn[a], i] - y[mconn[a], i])
    d = facets.dot(dr, n)
    for i in range(3):
        w[0, i] = dr[i] - d * n[i]
    h = facets.length(w[0])
    if h < 1e-12 * math.sqrt(area):  # rounding has no direction
        h = 0.0
    for i in range(3):
        w[0, i] = w[0, i] / h if h != 0.0 else 0.0
    return h


@kernel
def coefficient(mu, share, fluid, smooth, p):
    """m under the pressure p > 0; ``fluid``: the fluid's pressure, or the part f of the load that it bears (smooth)."""
    return mu * (1.0 - min(share * (fluid if smooth else fluid / p), 1.0))


@kernel
def tractions(
    T, x, y, sconn, scount, facet, mconn, mcount, points, normals, N, G, M, gap, eps, L, Lt, mu, share, fluid, smooth,
    offset, partner, rs, before, rs_before, sticks, dg, s, m, p, t,
):  # fmt: skip
    """Tractions t (q, 3) and pressures p (q,); points that stick get the partner ``before`` back.

    sticks (q,), dg (q, 3): those that do, and their distances; s (q, 3), m (q,): directions of slip, coefficients.
    """
    gs, gp, w = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    dr, da, H, at = np.empty(3), np.empty(3), np.empty(9), np.empty(3)
    for q in range(len(partner)):
        sticks[q], p[q], m[q] = False, 0.0, 0.0
        for i in range(3):
            t[q, i] = 0.0
        e, n = partner[q], normals[q]
        if e < 0:
            continue
        o = before[q]
        if o >= 0:
            facets.shape(T, mcount[o], rs_before[q, 0], rs_before[q, 1], H)
            facets.place(x, mconn[o], mcount[o], H, at)
            tn = tt = 0.0
            for i in range(3):
                t[q, i] = Lt[q, i] + eps[q] * (at[i] - points[q, i])
                tn += t[q, i] * n[i]
            for i in range(3):
                tt += (t[q, i] - tn * n[i]) ** 2
            if tn < 0.0 and math.sqrt(tt) < -coefficient(mu, share, fluid[q], smooth, -tn) * tn:
                sticks[q], p[q], partner[q] = True, -tn, o
                rs[q, 0], rs[q, 1] = rs_before[q, 0], rs_before[q, 1]
                for i in range(3):
                    dg[q, i] = at[i] - points[q, i] + offset * n[i]
                continue
        p[q] = max(L[q] + eps[q] * gap[q], 0.0)
        if p[q] != 0.0:
            f = facet[q]
            slip(x, y, sconn[f], scount[f], mconn[e], mcount[e], N[q], G[q], M[q], n, gap[q], gs, gp, w, dr, da)
            m[q] = coefficient(mu, share, fluid[q], smooth, p[q])
        for i in range(3):
            if p[q] != 0.0:
                s[q, i] = w[0, i]
            t[q, i] = -p[q] * (n[i] + m[q] * s[q, i]) if p[q] != 0.0 else 0.0


@kernel
def _skew(a, b, G, d, f, out):
    """out (3, 3) = f (G_r [b]x - G_s [a]x): what a change of a facet's node does to its area vector, turned."""
    u = f * (G[d, 0] * b[0] - G[d, 1] * a[0])
    v = f * (G[d, 0] * b[1] - G[d, 1] * a[1])
    w = f * (G[d, 0] * b[2] - G[d, 1] * a[2])
    out[0, 0] = out[1, 1] = out[2, 2] = 0.0
    out[0, 1], out[0, 2], out[1, 2] = -w, v, -u
    out[1, 0], out[2, 0], out[2, 1] = w, -v, u


@kernel
def _times(A, B, out):
    """out = A B."""
    for i in range(3):
        for j in range(3):
            out[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]


@kernel
def _slip_laws(n, s, dr, m, g, h, area, Q, L1, c, w):
    """Q = (I - s s) / h (I - n n), c = Q m / |a|, L1 = Q' ((P m' - I)(-g) + R) P with P = I - n n."""
    mn, dn = facets.dot(m, n), facets.dot(dr, n)
    for i in range(3):
        for j in range(3):
            one = 1.0 if i == j else 0.0
            w[0, i, j] = (one - s[i] * s[j]) / h
            w[1, i, j] = one - n[i] * n[j]
            w[2, i, j] = (one * mn + n[i] * m[j]) / area
            w[3, i, j] = one * dn + n[i] * dr[j]
    _times(w[0], w[1], Q)
    _times(w[1], w[2], w[4])
    for i in range(3):
        c[i] = (Q[i, 0] * m[0] + Q[i, 1] * m[1] + Q[i, 2] * m[2]) / area
        for j in range(3):
            w[4, i, j] = -g * (w[4, i, j] - (1.0 if i == j else 0.0)) + w[3, i, j]
    _times(w[0], w[4], w[2])
    _times(w[2], w[1], L1)


@kernel
def _primary(K, ns, nm, W, G, gs, gp, cs, n, s, c, Q, L1, g, f, h, area, w):
    """What the motion of the primary facet adds, f and h being m and mu times the (negative) traction per point."""
    for d in range(ns):
        _skew(gs[0], gs[1], G, d, 1.0 / area, w[0])
        _skew(gp[0], gp[1], G, d, 1.0 / area, w[1])
        _times(L1, w[0], w[2])
        _times(Q, w[1], w[3])
        mc = 0.0
        for i in range(3):
            mc += n[i] * (cs[0, i] * G[d, 0] + cs[1, i] * G[d, 1])
        for i in range(3):
            an = w[0, i, 0] * n[0] + w[0, i, 1] * n[1] + w[0, i, 2] * n[2]
            w[4, 0, i], w[4, 1, i] = h * n[i] * mc - f * an, n[i] * mc + an
        for i in range(3):
            for l in range(3):
                v = s[i] * w[4, 0, l] + f * (-g * c[i] * w[4, 1, l] - w[2, i, l] - g * w[3, i, l])
                for b in range(ns + nm):
                    K[3 * b + i, 3 * d + l] += W[b] * v


@kernel
def stiffness(
    T, x, y, sconn, scount, facet, mconn, mcount, partner, rs, rows, ns, nm, N, G, M, weight, normals, gap, eps, p, mu,
    m, K,
):  # fmt: skip
    """K (rows, d, d) += what friction adds to :func:`.sliding_elastic.stiffness` (k = 1) for points that slip."""
    W, Gm, a, v = np.empty(18), np.empty((9, 2)), np.empty((2, 2)), np.empty(3)
    gs, gm, cs, cm = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    gp, w, work = np.empty((3, 3)), np.empty((3, 3)), np.empty((5, 3, 3))
    dr, da, c = np.empty(3), np.empty(3), np.empty(3)
    Q, L1 = np.empty((3, 3)), np.empty((3, 3))
    for j in range(len(rows)):
        q = rows[j]
        n, sn, mn = normals[q], sconn[facet[q]], mconn[partner[q]]
        h = slip(x, y, sn, ns, mn, nm, N[q], G[q], M[q], n, gap[q], gs, gp, w, dr, da)
        if h == 0.0:
            continue
        s = w[0]
        contact.weights(N[q], M[q], ns, nm, W)
        sliding_elastic.bases(x, T, sn, mn, ns, nm, G[q], rs[q, 0], rs[q, 1], 1.0, Gm, gs, gm, cs, cm, a)
        area = facets.length(gs[2])
        _slip_laws(n, s, dr, da, gap[q], h, area, Q, L1, c, work)
        c0, c1 = facets.dot(cs[0], n), facets.dot(cs[1], n)
        for i in range(3):
            v[i] = n[i] - c0 * gs[0, i] - c1 * gs[1, i]
        load = -p[q] * area * weight[q]
        f, t = mu * eps[q] * area * weight[q], m[q] * load
        _primary(K[j], ns, nm, W, G[q], gs, gp, cs, n, s, c, Q, L1, gap[q], t, mu * load, area, work)
        for i in range(3):
            for l in range(3):
                u = f * s[i] * v[l] + t * (c[i] * v[l] - Q[i, l])
                for b in range(ns + nm):
                    for d in range(ns + nm):
                        K[j, 3 * b + i, 3 * d + l] += u * W[b] * W[d]
        for b in range(nm):
            r = 3 * (ns + b)
            for l in range(3):
                u = t * (cm[0, l] * Gm[b, 0] + cm[1, l] * Gm[b, 1])
                for i in range(3):
                    for d in range(ns + nm):
                        K[j, r + i, 3 * d + l] += u * W[d] * s[i]
            for d in range(ns):
                u = Gm[b, 0] * (a[0, 0] * G[q, d, 0] + a[0, 1] * G[q, d, 1])
                u = gap[q] * t * (u + Gm[b, 1] * (a[1, 0] * G[q, d, 0] + a[1, 1] * G[q, d, 1]))
                for i in range(3):
                    for l in range(3):
                        K[j, r + i, 3 * d + l] += u * s[i] * n[l]
