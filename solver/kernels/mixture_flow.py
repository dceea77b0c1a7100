"""Fluxes of fluid and solutes at points of a mixture (formulas: :mod:`..multiphasic.flow`).

K (n, 6) permeability, D (n, m, 6) diffusivities, in Voigt order; D0 (n, m) free diffusivities; phi (n,) porosity;
kappa, ca (n, m) partition coefficients and actual concentrations; gp (n, 3), gc (n, m, 3) gradients.
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel


@kernel
def spread(v, T):
    """T (3, 3), symmetric, of Voigt's columns v (6,)."""
    T[0, 0], T[1, 1], T[2, 2] = v[0], v[1], v[2]
    T[0, 1] = T[1, 0] = v[3]
    T[1, 2] = T[2, 1] = v[4]
    T[0, 2] = T[2, 0] = v[5]


@kernel
def invert(T, out):
    """out = T^-1 of a symmetric T (3, 3)."""
    x = T[1, 1] * T[2, 2] - T[1, 2] * T[1, 2]
    y = T[1, 2] * T[0, 2] - T[0, 1] * T[2, 2]
    z = T[0, 1] * T[1, 2] - T[1, 1] * T[0, 2]
    k = 1.0 / (T[0, 0] * x + T[0, 1] * y + T[0, 2] * z)
    out[0, 0] = k * x
    out[0, 1] = out[1, 0] = k * y
    out[0, 2] = out[2, 0] = k * z
    out[1, 1] = k * (T[0, 0] * T[2, 2] - T[0, 2] * T[0, 2])
    out[2, 2] = k * (T[0, 0] * T[1, 1] - T[0, 1] * T[0, 1])
    out[1, 2] = out[2, 1] = k * (T[0, 1] * T[0, 2] - T[0, 0] * T[1, 2])


@kernel
def apply(T, v, out):
    """out = T v."""
    for a in range(3):
        out[a] = T[a, 0] * v[0] + T[a, 1] * v[1] + T[a, 2] * v[2]


@kernel
def conduct(i, RT, phi, K, D, D0, kappa, ca, gp, gc, Ki, Ke, Di, Dg, w):
    """K^-1 and the effective permeability (3, 3), D (m, 3, 3), D grad c (m, 3) and w (3,) of point ``i``."""
    m = D0.shape[1]
    drive, S = np.empty(3), np.empty((3, 3))
    spread(K[i], S)
    invert(S, Ki)
    for a in range(3):
        drive[a] = gp[i, a]
        for b in range(3):
            S[a, b] = Ki[a, b]
    for k in range(m):
        spread(D[i, k], Di[k])
        apply(Di[k], gc[i, k], Dg[k])
        drag = RT / phi[i] * ca[i, k] / D0[i, k]
        for a in range(3):
            drive[a] += RT * kappa[i, k] / D0[i, k] * Dg[k, a]
            S[a, a] += drag
            for b in range(3):
                S[a, b] -= drag / D0[i, k] * Di[k, a, b]
    invert(S, Ke)
    apply(Ke, drive, w)
    for a in range(3):
        w[a] = -w[a]


@kernel
def fluxes(RT, phi, K, D, D0, kappa, ca, gp, gc, w, j):
    """Fluxes w (n, 3) of fluid and j (n, m, 3) of solutes."""
    m = D0.shape[1]
    Ki, Ke, Di, Dg, Dw = (
        np.empty((3, 3)),
        np.empty((3, 3)),
        np.empty((m, 3, 3)),
        np.empty((m, 3)),
        np.empty(3),
    )
    for i in range(len(phi)):
        conduct(i, RT, phi, K, D, D0, kappa, ca, gp, gc, Ki, Ke, Di, Dg, w[i])
        for k in range(m):
            apply(Di[k], w[i], Dw)
            for a in range(3):
                j[i, k, a] = ca[i, k] / D0[i, k] * Dw[a] - kappa[i, k] * phi[i] * Dg[k, a]


@kernel
def balances(dt, steady, s, pressure, J, J_old, phi0, ca, stored_old, w, j, weight, fluid, made, out):
    """out (n, 4, 4 + m): what the test functions' values (0) and gradients (1..3) meet of u, p and the m solutes.

    Total stress, of s (n, 6) and the pressure; dt (w, fluid) and dt (j_k + sum_i weight_i j_i, made_k), less what is
    stored in the step. fluid (n,), made (n, m): supplies per current volume.
    """
    for i in range(len(J)):
        T, phi = out[i], 1.0 - phi0[i] / J[i]
        spread(s[i], T[1:, :3])
        T[0, 3] = dt * fluid[i] - (0.0 if steady else 1.0 - J_old[i] / J[i])
        for a in range(3):
            T[0, a] = 0.0
            T[1 + a, a] -= pressure[i]
            T[1 + a, 3] = dt * w[i, a]
            current = 0.0
            for k in range(len(weight)):
                current += weight[k] * j[i, k, a]
            for k in range(len(weight)):
                T[1 + a, 4 + k] = dt * (j[i, k, a] + current)
        for k in range(len(weight)):
            rate = 0.0 if steady else phi * ca[i, k] - stored_old[i, k] / J[i]
            T[0, 4 + k] = dt * made[i, k] - rate
