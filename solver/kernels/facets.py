"""Facets of contact surfaces: shape functions anywhere on them, and positions, tangents and normals there.

T (10, 10, 11) holds the shape functions of a facet of n nodes as polynomials: T[n, k, :2] are the exponents of
monomial k in r and s, T[n, k, 2:] its coefficients by node, T[n, 9, 0] the number of monomials.
x (node, 3) are positions, nodes (9,) those of a facet, of which the first n count.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel


@kernel
def _power(x, p):
    """x^p for p = 0, 1, 2."""
    if p < 0.5:
        return 1.0
    return x if p < 1.5 else x * x


@kernel
def _slope(x, p):
    """d/dx of x^p."""
    if p < 0.5:
        return 0.0
    return 1.0 if p < 1.5 else 2.0 * x


@kernel
def shape(T, n, r, s, H):
    """H (>= n,): shape functions at (r, s)."""
    for a in range(n):
        H[a] = 0.0
    for k in range(int(T[n, 9, 0])):
        m = _power(r, T[n, k, 0]) * _power(s, T[n, k, 1])
        for a in range(n):
            H[a] += T[n, k, 2 + a] * m


@kernel
def slopes(T, n, r, s, G):
    """G (>= n, 2): natural derivatives at (r, s)."""
    for a in range(n):
        G[a, 0] = G[a, 1] = 0.0
    for k in range(int(T[n, 9, 0])):
        i, j = T[n, k, 0], T[n, k, 1]
        mr, ms = _slope(r, i) * _power(s, j), _power(r, i) * _slope(s, j)
        for a in range(n):
            G[a, 0] += T[n, k, 2 + a] * mr
            G[a, 1] += T[n, k, 2 + a] * ms


@kernel
def curvatures(T, n, r, s, C):
    """C (>= n, 3): second natural derivatives rr, rs, ss at (r, s)."""
    for a in range(n):
        C[a, 0] = C[a, 1] = C[a, 2] = 0.0
    for k in range(int(T[n, 9, 0])):
        i, j = T[n, k, 0], T[n, k, 1]
        rr = 2.0 * _power(s, j) if i > 1.5 else 0.0
        ss = 2.0 * _power(r, i) if j > 1.5 else 0.0
        rs = _slope(r, i) * _slope(s, j)
        for a in range(n):
            C[a, 0] += T[n, k, 2 + a] * rr
            C[a, 1] += T[n, k, 2 + a] * rs
            C[a, 2] += T[n, k, 2 + a] * ss


@kernel
def place(x, nodes, n, H, out):
    """out (3,): sum H_a x_a."""
    out[0] = out[1] = out[2] = 0.0
    for a in range(n):
        b = nodes[a]
        for i in range(3):
            out[i] += H[a] * x[b, i]


@kernel
def tangents(x, nodes, n, G, t):
    """t (3, 3): tangents along r and s, and their cross product a."""
    for i in range(3):
        t[0, i] = t[1, i] = 0.0
    for a in range(n):
        b = nodes[a]
        for i in range(3):
            t[0, i] += G[a, 0] * x[b, i]
            t[1, i] += G[a, 1] * x[b, i]
    t[2, 0] = t[0, 1] * t[1, 2] - t[0, 2] * t[1, 1]
    t[2, 1] = t[0, 2] * t[1, 0] - t[0, 0] * t[1, 2]
    t[2, 2] = t[0, 0] * t[1, 1] - t[0, 1] * t[1, 0]


@kernel
def length(v):
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


@kernel
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def inside(n, r, s, tol):
    """Is (r, s) on a facet of n nodes, or within ``tol`` of it?"""
    if n == 4 or n >= 8:
        return -1.0 - tol <= r <= 1.0 + tol and -1.0 - tol <= s <= 1.0 + tol
    return r >= -tol and s >= -tol and r + s <= 1.0 + tol


@kernel
def frames(x, conn, count, facet, N, G, points, normals, detJ):
    """Positions, unit normals and area per natural area at integration points.

    facet (q,); N (q, 9), G (q, 9, 2): shape functions and natural derivatives there; out: points, normals (q, 3),
    detJ (q,).
    """
    t = np.empty((3, 3))
    for q in range(len(facet)):
        e = facet[q]
        place(x, conn[e], count[e], N[q], points[q])
        tangents(x, conn[e], count[e], G[q], t)
        detJ[q] = length(t[2])
        for i in range(3):
            normals[q, i] = t[2, i] / detJ[q]
