"""Invariants of a solid with one fiber direction, and the stress from its derivatives of the energy."""

from __future__ import annotations

import numpy as np

from ..jit import kernel


@kernel
def _left(F, J, i, d, a0, iso, b, n):
    """b (6,) and the spatial fiber direction n (3,), unit, of point i; returns I4. Of F~ where ``iso``."""
    k = J[i] ** (-2.0 / 3.0) if iso else 1.0
    f = F[i]
    for p in range(6):
        r = p if p < 3 else (0 if p != 4 else 1)
        q = p if p < 3 else (1 if p == 3 else 2)
        b[p] = k * (f[r, 0] * f[q, 0] + f[r, 1] * f[q, 1] + f[r, 2] * f[q, 2])
    m = 0.0
    for p in range(3):
        n[p] = f[p, 0] * a0[d, 0] + f[p, 1] * a0[d, 1] + f[p, 2] * a0[d, 2]
        m += n[p] * n[p]
    l = 1.0 / np.sqrt(m)
    for p in range(3):
        n[p] *= l
    return k * m


@kernel
def _times(b, n, bn):
    bn[0] = b[0] * n[0] + b[3] * n[1] + b[5] * n[2]
    bn[1] = b[3] * n[0] + b[1] * n[1] + b[4] * n[2]
    bn[2] = b[5] * n[0] + b[4] * n[1] + b[2] * n[2]


@kernel
def fiber_invariants(F, J, a0, iso, out):
    """I1, I2, I4, I5 as rows of ``out`` (4, n) for reference directions a0 (1|n, 3)."""
    b, n, bn = np.empty(6), np.empty(3), np.empty(3)
    for i in range(len(J)):
        I4 = _left(F, J, i, i if a0.shape[0] > 1 else 0, a0, iso, b, n)
        _times(b, n, bn)
        I1 = b[0] + b[1] + b[2]
        square = b[0] ** 2 + b[1] ** 2 + b[2] ** 2 + 2.0 * (b[3] ** 2 + b[4] ** 2 + b[5] ** 2)
        out[0, i], out[1, i], out[2, i] = I1, 0.5 * (I1 * I1 - square), I4
        out[3, i] = I4 * (n[0] * bn[0] + n[1] * bn[1] + n[2] * bn[2])


@kernel
def fiber_stress(F, J, a0, iso, W, s):
    """s (n, 6) = 2/J [(W1 + I1 W2) b - W2 b^2 + I4 W4 n n + I4 W5 (n bn + bn n)] + WJ I, deviatoric where ``iso``.

    ``W`` (n, 5) holds W1, W2, W4, W5, WJ.
    """
    b, n, bn = np.empty(6), np.empty(3), np.empty(3)
    for i in range(len(J)):
        I4 = _left(F, J, i, i if a0.shape[0] > 1 else 0, a0, iso, b, n)
        _times(b, n, bn)
        I1 = b[0] + b[1] + b[2]
        k1, k2, k4, k5 = W[i, 0] + I1 * W[i, 1], W[i, 1], I4 * W[i, 2], I4 * W[i, 3]
        b2 = (
            b[0] * b[0] + b[3] * b[3] + b[5] * b[5],
            b[3] * b[3] + b[1] * b[1] + b[4] * b[4],
            b[5] * b[5] + b[4] * b[4] + b[2] * b[2],
            b[0] * b[3] + b[3] * b[1] + b[5] * b[4],
            b[3] * b[5] + b[1] * b[4] + b[4] * b[2],
            b[0] * b[5] + b[3] * b[4] + b[5] * b[2],
        )
        h = 2.0 / J[i]
        for p in range(6):
            r = p if p < 3 else (0 if p != 4 else 1)
            q = p if p < 3 else (1 if p == 3 else 2)
            mixed = n[r] * bn[q] + bn[r] * n[q]
            s[i, p] = h * (k1 * b[p] - k2 * b2[p] + k4 * n[r] * n[q] + k5 * mixed)
        mean = (s[i, 0] + s[i, 1] + s[i, 2]) / 3.0 if iso else 0.0
        for p in range(3):
            s[i, p] += W[i, 4] - mean
