"""Stress and tangent of an isotropic solid from its principal stretches."""

from __future__ import annotations

from ..jit import kernel
from .tensors import add_circles, add_dyad, add_dyads, dyad_of


@kernel
def add_spectral(s, c, i, k, w, V, tau, H, N):
    """Add k times the Kirchhoff stress and its tangent.

    ``w`` (3,) eigenvalues of b and ``V`` their vectors as columns; ``tau`` = dW/d ln(lambda) and ``H`` its
    derivative (3, 3); ``N`` (3, 6) scratch. c = sum_ab (H_ab - 2 tau_a delta_ab) N_a dyad N_b + shear terms
    2 (w_b tau_a - w_a tau_b) / (w_a - w_b), with their limit where two stretches meet (Ogden,
    Non-linear Elastic Deformations, section 6.1.4).
    """
    for a in range(3):
        dyad_of(V[0, a], V[1, a], V[2, a], N[a])
        for p in range(6):
            s[i, p] += k * tau[a] * N[a, p]
    if c.shape[0] == 0:
        return
    for a in range(3):
        add_dyad(c, i, k * (H[a, a] - 2.0 * tau[a]), N[a])
        for b in range(a):
            add_dyads(c, i, k * H[a, b], N[a], N[b])
            d = w[a] - w[b]
            if abs(d) > 1e-8 * (w[a] + w[b]):
                e = 2.0 * (w[b] * tau[a] - w[a] * tau[b]) / d
            else:
                e = 0.5 * (H[a, a] + H[b, b]) - tau[a] - tau[b] - H[a, b]
            add_circles(c, i, k * e, N[a], N[b])
