"""Where the normal of one surface meets another: FEBio's projection of contact along the primary surface's normal.

A ray p + g n meets a facet where r(r, s) = p + g n, found from the triangles of its nodes by Newton's method.
Facets that face away (n . m >= 0 with m the facet's normal) are not met.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from . import facets, tree


@kernel
def _cross(a, b, out):
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@kernel
def _triangle(x, i, j, k, p, n, tol, w, out):
    """Meet the triangle of nodes i, j, k: out (3,) = its r, s and the distance g. w (5, 3): work."""
    e, f, m, q = w[0], w[1], w[2], w[3]
    for c in range(3):
        e[c], f[c] = x[j, c] - x[i, c], x[k, c] - x[i, c]
    _cross(e, f, m)
    h = facets.length(m)
    if h == 0.0:
        return False
    d = facets.dot(n, m) / h
    if not d < 0.0:
        return False
    g = 0.0
    for c in range(3):
        g += m[c] / h * (x[i, c] - p[c])
    g /= d
    for c in range(3):
        q[c] = p[c] + g * n[c] - x[i, c]
    ee, ef, ff = facets.dot(e, e), facets.dot(e, f), facets.dot(f, f)
    det = ee * ff - ef * ef
    eq, fq = facets.dot(e, q), facets.dot(f, q)
    r, s = (ff * eq - ef * fq) / det, (ee * fq - ef * eq) / det
    out[0], out[1], out[2] = r, s, g
    return r >= -tol and s >= -tol and r + s <= 1.0 + tol


@kernel
def _guess(x, nodes, n, p, d, tol, w, out):
    """A first guess of the meeting on a facet of n nodes by its triangles; False where the ray misses them."""
    if n == 3:
        return _triangle(x, nodes[0], nodes[1], nodes[2], p, d, tol, w, out)
    if n == 4:
        if _triangle(x, nodes[0], nodes[1], nodes[3], p, d, tol, w, out):
            out[0], out[1] = 2.0 * out[0] - 1.0, 2.0 * out[1] - 1.0
            return True
        if _triangle(x, nodes[2], nodes[3], nodes[1], p, d, tol, w, out):
            out[0], out[1] = 1.0 - 2.0 * out[0], 1.0 - 2.0 * out[1]
            return True
        return False
    if n >= 8:
        out[0] = out[1] = out[2] = 0.0
        return True
    if _triangle(x, nodes[0], nodes[3], nodes[5], p, d, tol, w, out):
        out[0], out[1] = 0.5 * out[0], 0.5 * out[1]
        return True
    if _triangle(x, nodes[3], nodes[1], nodes[4], p, d, tol, w, out):
        out[0], out[1] = 0.5 + 0.5 * out[0], 0.5 * out[1]
        return True
    if _triangle(x, nodes[5], nodes[4], nodes[2], p, d, tol, w, out):
        out[0], out[1] = 0.5 * out[0], 0.5 + 0.5 * out[1]
        return True
    if _triangle(x, nodes[4], nodes[5], nodes[3], p, d, tol, w, out):
        out[0], out[1] = 0.5 - 0.5 * out[0], 0.5 - 0.5 * out[1]
        return True
    return False


@kernel
def meet(T, x, nodes, n, p, d, tol, H, G, w, out):
    """Does the ray from p along d meet a facet? out (3,): r, s and the distance. H (9,), G (9, 2), w (6, 3): work."""
    if not _guess(x, nodes, n, p, d, tol, w, out):
        return False
    if n == 3:
        return True
    r, s, g = out[0], out[1], out[2]
    t, F, c, e = w[:3], w[3], w[4], w[5]
    most = 5 if n == 4 or n == 7 else 10
    for _ in range(most - 1):
        facets.shape(T, n, r, s, H)
        facets.slopes(T, n, r, s, G)
        facets.place(x, nodes, n, H, F)
        facets.tangents(x, nodes, n, G, t)
        for i in range(3):
            F[i] = p[i] + g * d[i] - F[i]
        # [-t_r, -t_s, d] (dr, ds, dg) = -F by Cramer's rule
        det = facets.dot(t[2], d)
        _cross(F, t[1], c)
        dr = facets.dot(c, d) / det
        _cross(t[0], F, e)
        ds = facets.dot(e, d) / det
        dg = -facets.dot(t[2], F) / det
        r, s, g = r + dr, s + ds, g + dg
        if not math.sqrt(dr * dr + ds * ds + dg * dg) > 1e-7:
            out[0], out[1], out[2] = r, s, g
            return det <= 0.0 and facets.inside(n, r, s, tol)
    return False


@kernel
def nearest(T, x, conn, count, order, boxes, p, d, tol, least, most, absolute, H, G, w, stack, out):
    """The facet met at the smallest distance (``absolute``: its size) in (least, most), or -1; out as in :func:`meet`.

    stack (64,): work. Equal distances: the facet that comes first.
    """
    L, m = (len(boxes) + 1) // 2, len(order)
    best, g, r, s = -1, 0.0, 0.0, 0.0
    stack[0], top = 0, 1
    while top > 0:
        top -= 1
        k = stack[top]
        if not tree.crosses(boxes[k], p, d, least, most):
            continue
        if k < L - 1:
            stack[top], stack[top + 1] = 2 * k + 1, 2 * k + 2
            top += 2
            continue
        l = k - (L - 1)
        for j in range(m * l // L, m * (l + 1) // L):
            e = order[j]
            if not meet(T, x, conn[e], count[e], p, d, tol, H, G, w, out) or not least < out[2] < most:
                continue
            new, old = (abs(out[2]), abs(g)) if absolute else (out[2], g)
            if best < 0 or new < old or (new == old and e < best):
                best, g, r, s = e, out[2], out[0], out[1]
    out[0], out[1], out[2] = r, s, g
    return best


@kernel
def find(T, x, conn, count, order, boxes, points, normals, tol, radius, absolute, keep, update, partner, rs):
    """Facets met by the normals of integration points.

    points, normals (q, 3); partner (q,) the facet met before or -1, kept where the ray still meets it (if ``keep``),
    else searched anew within ``radius`` (if ``update``); rs (q, 2): where.
    """
    H, G, w, out = np.empty(9), np.empty((9, 2)), np.empty((6, 3)), np.empty(3)
    stack = np.empty(64, np.int64)
    for q in range(len(partner)):
        e = partner[q] if keep else -1
        if e >= 0 and not meet(T, x, conn[e], count[e], points[q], normals[q], tol, H, G, w, out):
            e = -1
        if e < 0 and update:
            e = nearest(
                T, x, conn, count, order, boxes, points[q], normals[q], tol, -radius, radius, absolute, H, G, w,
                stack, out,
            )  # fmt: skip
        partner[q] = e
        rs[q, 0] = out[0] if e >= 0 else 0.0
        rs[q, 1] = out[1] if e >= 0 else 0.0
