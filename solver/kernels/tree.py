"""A tree of boxes over facets or nodes: the one nearest to a point, and those that a line may pass.

Items are sorted along a curve that fills space and cut into L = 2^k leaves of equal size: leaf l holds
order[m l // L : m (l + 1) // L]. Node k of the binary tree has children 2k + 1 and 2k + 2, the leaves come last;
boxes (2L - 1, 6) are lows and highs. Sources: Morton (1966); Karras, High Performance Graphics (2012).
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel


@kernel
def fit(x, conn, count, order, margin, boxes):
    """Fit the boxes to items (conn, count) at positions x, each enlarged by ``margin`` times its size."""
    L = (len(boxes) + 1) // 2
    m = len(order)
    for k in range(len(boxes) - 1, -1, -1):
        b = boxes[k]
        for i in range(3):
            b[i], b[3 + i] = np.inf, -np.inf
        if k < L - 1:
            for c in range(2 * k + 1, 2 * k + 3):
                for i in range(3):
                    b[i] = min(b[i], boxes[c, i])
                    b[3 + i] = max(b[3 + i], boxes[c, 3 + i])
            continue
        l = k - (L - 1)
        for j in range(m * l // L, m * (l + 1) // L):
            e = order[j]
            size = 0.0
            for i in range(3):
                lo, hi = np.inf, -np.inf
                for a in range(count[e]):
                    v = x[conn[e, a], i]
                    lo, hi = min(lo, v), max(hi, v)
                size = max(size, hi - lo)
            for i in range(3):
                for a in range(count[e]):
                    v = x[conn[e, a], i]
                    b[i] = min(b[i], v - margin * size)
                    b[3 + i] = max(b[3 + i], v + margin * size)


@kernel
def distance2(box, p):
    """Squared distance of a point from a box."""
    d = 0.0
    for i in range(3):
        g = max(box[i] - p[i], p[i] - box[3 + i], 0.0)
        d += g * g
    return d


@kernel
def crosses(box, p, n, t0, t1):
    """Does the line p + t n, t0 <= t <= t1, pass the box?"""
    for i in range(3):
        if n[i] == 0.0:
            if p[i] < box[i] or p[i] > box[3 + i]:
                return False
            continue
        a, b = (box[i] - p[i]) / n[i], (box[3 + i] - p[i]) / n[i]
        if a > b:
            a, b = b, a
        t0, t1 = max(t0, a), min(t1, b)
        if t0 > t1:
            return False
    return True
