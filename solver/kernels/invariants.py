"""Stress and tangent of W(I1, I2, J) from derivatives given at each point."""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from .isochoric import add_isochoric
from .tensors import add_circle, add_dyad, add_dyads, add_identity, left_cauchy_green, square, trace


@kernel
def add_invariant(F, J, D, iso, s, c):
    """Add 2/J [(W1 + I1 W2) b - W2 b^2] + WJ I and its tangent.

    ``D`` (n, 7): W1, W2, W11, W12, W22, WJ, WJJ. ``iso``: the invariants are those of F~ = J^-1/3 F, only the
    deviatoric part is added and WJ is not used. Mixed derivatives by J and I are taken as zero.
    """
    b, b2, T, h = np.empty(6), np.empty(6), np.empty(6), np.empty((1, 6, 6))
    for i in range(len(J)):
        left_cauchy_green(F, i, J[i] ** (-2.0 / 3.0) if iso else 1.0, b)
        square(b, b2)
        I1, Ji = trace(b), 1.0 / J[i]
        W1, W2, W11, W12, W22 = D[i, 0], D[i, 1], D[i, 2], D[i, 3], D[i, 4]
        if iso:
            add_isochoric(s, c, i, Ji, b, b2, I1, W1, W2, W11, W12, W22, T, h)
            continue
        for p in range(6):
            s[i, p] += 2.0 * Ji * ((W1 + I1 * W2) * b[p] - W2 * b2[p])
        for p in range(3):
            s[i, p] += D[i, 5]
        if c.shape[0] > 0:
            add_dyad(c, i, 4.0 * Ji * (W11 + 2.0 * I1 * W12 + I1 * I1 * W22 + W2), b)
            add_circle(c, i, -4.0 * Ji * W2, b)
            add_dyads(c, i, -4.0 * Ji * (W12 + I1 * W22), b, b2)
            add_dyad(c, i, 4.0 * Ji * W22, b2)
            add_identity(c, i, D[i, 5] + J[i] * D[i, 6], -2.0 * D[i, 5])
