"""Directions of a sphere spanned by theta and a one-dimensional rule in cos(phi)."""

from __future__ import annotations

import numpy as np

from ..jit import kernel


@kernel
def span(V, lo, hi, ct, st, x, w, scale, N, weight):
    """Directions N (k, a b, 3) and weights (k, a b) about axes V (k, 3, 3; columns).

    Of a angles theta (cosines ``ct``, sines ``st``) and b points ``x``, ``w`` of a rule on (-1, 1), mapped to the
    limits lo, hi (k, a) of cos(phi) at each angle; weights are times ``scale``.
    """
    b = len(x)
    for k in range(len(V)):
        v = V[k]
        for i in range(len(ct)):
            half, mid = 0.5 * (hi[k, i] - lo[k, i]), 0.5 * (hi[k, i] + lo[k, i])
            for j in range(b):
                z = mid + half * x[j]
                r = np.sqrt(max(1.0 - z * z, 0.0))
                p, q = ct[i] * r, st[i] * r
                m = i * b + j
                N[k, m, 0] = v[0, 0] * p + v[0, 1] * q + v[0, 2] * z
                N[k, m, 1] = v[1, 0] * p + v[1, 1] * q + v[1, 2] * z
                N[k, m, 2] = v[2, 0] * p + v[2, 1] * q + v[2, 2] * z
                weight[k, m] = scale * half * w[j]


@kernel
def turn(N, Q, out):
    """out (n, m, 3) = Q N for directions N (1|n, m, 3) and rotations Q (1|n, 3, 3)."""
    for i in range(len(out)):
        d = N[i if N.shape[0] > 1 else 0]
        q = Q[i if Q.shape[0] > 1 else 0]
        for j in range(out.shape[1]):
            x, y, z = d[j, 0], d[j, 1], d[j, 2]
            for p in range(3):
                out[i, j, p] = q[p, 0] * x + q[p, 1] * y + q[p, 2] * z
