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


@kernel
def fiber_tangent(F, J, a0, iso, W, H, c):
    """Add the spatial tangent of W(I1, I4, I5) to c (n, 6, 6): 4/J K, or, isochoric where ``iso``, what follows.

    ``W`` (n, 5) holds W1, 0, W4, W5, 0; ``H`` (n, 6) W11, W14, W15, W44, W45, W55. With b and I1, I4, I5 of F~, n the
    fiber, A = I4 n n, P = I4 (n bn + bn n), dev s the stress:
    c = -2/3 (dev s I + I dev s) + 4/(3 J) (W1 I1 + W4 I4 + 2 W5 I5) (1 - I I/3)
        + 4/J [K - (k I + I k)/3 + (k:1) I I/9],
    K = W11 b b + W14 (b A + A b) + W15 (b P + P b) + W44 A A + W45 (A P + P A) + W55 P P + W5 (A x b + b x A),
    k = K : 1.
    (Weiss, Maker & Govindjee, Comput Methods Appl Mech Engrg 135 (1996) 107, for the form.)
    """
    b, n, bn = np.empty(6), np.empty(3), np.empty(3)
    A, P, k, s, one = np.empty(6), np.empty(6), np.empty(6), np.empty(6), np.zeros(6)
    one[0] = one[1] = one[2] = 1.0 if iso else 0.0  # what the projection takes off
    for i in range(len(J)):
        I4 = _left(F, J, i, i if a0.shape[0] > 1 else 0, a0, iso, b, n)
        _times(b, n, bn)
        I1 = b[0] + b[1] + b[2]
        I5 = I4 * (n[0] * bn[0] + n[1] * bn[1] + n[2] * bn[2])
        W1, W4, W5 = W[i, 0], W[i, 2], W[i, 3]
        W11, W14, W15, W44, W45, W55 = H[i, 0], H[i, 1], H[i, 2], H[i, 3], H[i, 4], H[i, 5]
        for p in range(6):
            r = p if p < 3 else (0 if p != 4 else 1)
            q = p if p < 3 else (1 if p == 3 else 2)
            A[p] = I4 * n[r] * n[q]
            P[p] = I4 * (n[r] * bn[q] + bn[r] * n[q])
        h = 2.0 / J[i]
        for p in range(6):
            s[p] = h * (W1 * b[p] + W4 * A[p] + W5 * P[p])
        mean = (s[0] + s[1] + s[2]) / 3.0
        for p in range(3):
            s[p] -= mean
        k1 = W11 * I1 + W14 * I4 + 2.0 * W15 * I5
        k4 = W14 * I1 + W44 * I4 + 2.0 * W45 * I5
        k5 = W15 * I1 + W45 * I4 + 2.0 * W55 * I5 + W5
        for p in range(6):
            k[p] = k1 * b[p] + k4 * A[p] + k5 * P[p]
        trace = k[0] + k[1] + k[2]
        g = 4.0 / (3.0 * J[i]) * (W1 * I1 + W4 * I4 + 2.0 * W5 * I5) if iso else 0.0
        f = 4.0 / J[i]
        for p in range(6):
            r = p if p < 3 else (0 if p != 4 else 1)
            u = p if p < 3 else (1 if p == 3 else 2)
            for q in range(6):
                v = q if q < 3 else (0 if q != 4 else 1)
                w = q if q < 3 else (1 if q == 3 else 2)
                mixed = _at(A, r, v) * _at(b, u, w) + _at(A, r, w) * _at(b, u, v)
                mixed += _at(b, r, v) * _at(A, u, w) + _at(b, r, w) * _at(A, u, v)
                K = W11 * b[p] * b[q] + W14 * (b[p] * A[q] + A[p] * b[q]) + W15 * (b[p] * P[q] + P[p] * b[q])
                K += W44 * A[p] * A[q] + W45 * (A[p] * P[q] + P[p] * A[q]) + W55 * P[p] * P[q] + 0.5 * W5 * mixed
                K += (trace * one[p] * one[q] / 3.0 - k[p] * one[q] - one[p] * k[q]) / 3.0
                unit = 0.0
                if p == q:
                    unit = 1.0 if p < 3 else 0.5
                c[i, p, q] += f * K + g * (unit - one[p] * one[q] / 3.0)
                c[i, p, q] -= 2.0 / 3.0 * (s[p] * one[q] + one[p] * s[q])


@kernel
def _at(a, r, q):
    """Component (r, q) of a symmetric tensor."""
    if r == q:
        return a[r]
    if r + q == 1:
        return a[3]
    return a[4] if r + q == 3 else a[5]
