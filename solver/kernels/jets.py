"""Values with derivatives: rows (13,) of a value and its derivatives by twelve unknowns; see :mod:`..rigid.jets`."""

from __future__ import annotations

from ..jit import kernel
from .rigid import turn


@kernel
def cross(a, b, out):
    """out = a x b, all (3, 13)."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        out[i, 0] = a[j, 0] * b[k, 0] - a[k, 0] * b[j, 0]
        for m in range(1, out.shape[1]):
            out[i, m] = a[j, 0] * b[k, m] - a[k, 0] * b[j, m] - (b[j, 0] * a[k, m] - b[k, 0] * a[j, m])


@kernel
def dot(a, b, out):
    """out = a . b (1, 13) of vectors (k, 13)."""
    out[0] = 0.0
    for i in range(a.shape[0]):
        out[0, 0] += a[i, 0] * b[i, 0]
        for m in range(1, out.shape[1]):
            out[0, m] += a[i, 0] * b[i, m] + b[i, 0] * a[i, m]


@kernel
def scale(a, c, out):
    """out = c a of a vector (k, 13) and a number (1, 13)."""
    for i in range(a.shape[0]):
        out[i, 0] = a[i, 0] * c[0, 0]
        for m in range(1, out.shape[1]):
            out[i, m] = a[i, m] * c[0, 0] + a[i, 0] * c[0, m]


@kernel
def turned(q, q_old, Z, alpha, slot, out):
    """out (3, 13): the vector Z (3,) turned by q, at a time ``alpha`` between the last step (q_old) and the present.

    Its derivatives by a small rotation after the present one are behind ``slot``.
    """
    x, y, z = turn(q[0], q[1], q[2], q[3], Z[0], Z[1], Z[2])
    out[:] = 0.0
    k, b = 1 + slot, 1.0 - alpha
    out[0, k + 1], out[0, k + 2] = alpha * z, -alpha * y
    out[1, k], out[1, k + 2] = -alpha * z, alpha * x
    out[2, k], out[2, k + 1] = alpha * y, -alpha * x
    if alpha != 1.0:
        r, s, t = turn(q_old[0], q_old[1], q_old[2], q_old[3], Z[0], Z[1], Z[2])
        x, y, z = alpha * x + b * r, alpha * y + b * s, alpha * z + b * t
    out[0, 0], out[1, 0], out[2, 0] = x, y, z
