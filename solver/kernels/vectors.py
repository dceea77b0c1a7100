"""Sums over long vectors, and between vectors over equations and nodal arrays."""

from __future__ import annotations

from ..jit import kernel


@kernel
def inner(a, b):
    """a . b in eight sums, which the processor adds side by side."""
    n = len(a)
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = 0.0
    whole = n - n % 8
    for i in range(0, whole, 8):
        s0 += a[i] * b[i]
        s1 += a[i + 1] * b[i + 1]
        s2 += a[i + 2] * b[i + 2]
        s3 += a[i + 3] * b[i + 3]
        s4 += a[i + 4] * b[i + 4]
        s5 += a[i + 5] * b[i + 5]
        s6 += a[i + 6] * b[i + 6]
        s7 += a[i + 7] * b[i + 7]
    for i in range(whole, n):
        s0 += a[i] * b[i]
    return ((s0 + s4) + (s1 + s5)) + ((s2 + s6) + (s3 + s7))


@kernel
def total(a):
    """The sum of a, in eight sums."""
    n = len(a)
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = 0.0
    whole = n - n % 8
    for i in range(0, whole, 8):
        s0 += a[i]
        s1 += a[i + 1]
        s2 += a[i + 2]
        s3 += a[i + 3]
        s4 += a[i + 4]
        s5 += a[i + 5]
        s6 += a[i + 6]
        s7 += a[i + 7]
    for i in range(whole, n):
        s0 += a[i]
    return ((s0 + s4) + (s1 + s5)) + ((s2 + s6) + (s3 + s7))


@kernel
def add_along(v, w, t):
    """t += v (w . t)"""
    c = inner(w, t)
    for i in range(len(t)):
        t[i] += v[i] * c


@kernel
def gather(eq, nodal, out):
    """Entries of a nodal array (node, column) at their equations ``eq`` (-1: none)."""
    for a in range(eq.shape[0]):
        for i in range(eq.shape[1]):
            if eq[a, i] >= 0:
                out[eq[a, i]] = nodal[a, i]


@kernel
def place(eq, free, total, increment, u, target, d):
    """d (node, column) <- total + increment + u at free equations, ``target`` at prescribed ones (``free``: -1)."""
    for a in range(eq.shape[0]):
        for i in range(eq.shape[1]):
            e = eq[a, i]
            if e >= 0:
                d[a, i] = total[e] + increment[e] + u[e] if free[e] >= 0 else target[a, i]


@kernel
def put(places, rows, a, out):
    """out[places] = a[rows], for flat arrays."""
    for i in range(len(places)):
        out[places[i]] = a[rows[i]]


@kernel
def add(c, a, out):
    """out += c a."""
    for i in range(len(a)):
        out[i] += c * a[i]


@kernel
def put_times(places, c, a, out):
    """out[places] = c a, for flat arrays."""
    for i in range(len(places)):
        out[places[i]] = c * a[i]


@kernel
def put_difference(places, a, b, out):
    """out = a - b at places, for flat arrays."""
    for i in range(len(places)):
        out[places[i]] = a[places[i]] - b[places[i]]


@kernel
def put_sum(rows, a, c, b, out):
    """out[rows] = a[rows] + c b."""
    for i in range(len(rows)):
        out[rows[i]] = a[rows[i]] + c * b[i]


@kernel
def rates(now, before, columns, dt, out):
    """out (n, k) = (now - before) / dt in k columns."""
    for i in range(len(out)):
        for k in range(len(columns)):
            out[i, k] = (now[i, columns[k]] - before[i, columns[k]]) / dt
