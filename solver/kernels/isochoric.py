"""Distortional stress and tangent of W~(I1~, I2~) from its derivatives."""

from __future__ import annotations

from ..jit import kernel
from .tensors import (
    add_circle,
    add_deviatoric_stress,
    add_deviatoric_tangent,
    add_dyad,
    add_dyads,
    clear,
)


@kernel
def add_isochoric(s, c, i, Ji, B, B2, I1, W1, W2, W11, W12, W22, T, h):
    """Add dev(2 (W1 + I1 W2) B - 2 W2 B^2) / J and its tangent; ``B`` of F~; ``T`` (6,), ``h`` (1, 6, 6) scratch.

    Holzapfel, Nonlinear Solid Mechanics, section 6.4 (stress) and 6.6 (tangent).
    """
    clear(T, h)
    for p in range(6):
        T[p] = 2.0 * ((W1 + I1 * W2) * B[p] - W2 * B2[p])
    add_deviatoric_stress(s, i, Ji, T)
    if c.shape[0] > 0:
        add_dyad(h, 0, 4.0 * (W11 + 2.0 * I1 * W12 + I1 * I1 * W22 + W2), B)
        add_circle(h, 0, -4.0 * W2, B)
        if W12 != 0.0 or W22 != 0.0:
            add_dyads(h, 0, -4.0 * (W12 + I1 * W22), B, B2)
            add_dyad(h, 0, 4.0 * W22, B2)
        add_deviatoric_tangent(c, i, Ji, T, h)
