"""How the flux of fluid in a mixture changes (formulas and arrays: :mod:`.mixture_tangent`)."""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from .mixture_flow import apply

VOIGT = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])


@kernel
def pair(M, v, f, first, out):
    """out_akl += f (first M_ak v_l + (2 - first) M_al v_k): what the rate of a metric makes of M . v."""
    for a in range(3):
        for k in range(3):
            for l in range(3):
                out[a, k, l] += f * (first * M[a, k] * v[l] + (2.0 - first) * M[a, l] * v[k])


@kernel
def metric(v, f, out):
    """out_akl += f (v_a delta_kl - v_k delta_al - v_l delta_ak)."""
    for a in range(3):
        for k in range(3):
            out[a, k, k] += f * v[a]
            out[a, k, a] -= f * v[k]
            out[a, a, k] -= f * v[k]


@kernel
def strained(v, T, f, out):
    """out_akl += f v_c T_cakl for T (6, 6)."""
    for a in range(3):
        for k in range(3):
            for l in range(3):
                q = VOIGT[k, l]
                x = v[0] * T[VOIGT[0, a], q] + v[1] * T[VOIGT[1, a], q] + v[2] * T[VOIGT[2, a], q]
                out[a, k, l] += f * x


@kernel
def contract(M, T, f, out):
    """out_akl += f M_ab T_bkl."""
    for a in range(3):
        for k in range(3):
            for l in range(3):
                out[a, k, l] += f * (M[a, 0] * T[0, k, l] + M[a, 1] * T[1, k, l] + M[a, 2] * T[2, k, l])


@kernel
def by_displacement(i, RT, exact, J, phi, D0, kappa, ca, c, dkdJ, gc, dK, dD, Ki, Ke, D, Dg, w, out):
    """The change of w_a, convected, by grad_l of displacement k, of point ``i``: out (3, 3, 3).

    ``exact`` 1.0: the tangent is consistent, 0.0: as FEBio has it, which swaps two of the indices besides.
    """
    m = D0.shape[1]
    v, y, x = np.empty(3), np.empty(3), np.zeros(3)
    inner, held = np.zeros((3, 3, 3)), np.zeros((3, 3, 3))
    apply(Ki, w, v)
    metric(v, 2.0, inner)
    if dK.shape[0] > 0:
        strained(v, dK[i], 1.0, held)
        contract(Ki, held, -1.0, inner)
        held[:] = 0.0
    b = 0.0
    for k in range(m):
        beta = RT * ca[i, k] / phi[i] / D0[i, k]
        b += beta
        alpha = RT * c[i, k] * J[i] / D0[i, k] / phi[i]
        alpha *= dkdJ[i, k] - kappa[i, k] / phi[i] * (1.0 - phi[i]) / J[i]
        apply(D[k], w, y)
        for a in range(3):
            x[a] += alpha * (w[a] - y[a] / D0[i, k])
        if dD.shape[0] > 0:
            strained(w, dD[i, k], -beta / D0[i, k], inner)
    for a in range(3):
        for k in range(3):
            inner[a, k, k] += x[a] + b * w[a]
            inner[a, a, k] -= exact * b * w[k]
            inner[a, k, a] -= (2.0 - exact) * b * w[k]
    metric(w, 2.0, held)
    contract(Ke, inner, -1.0, held)
    for a in range(3):
        for k in range(3):
            for l in range(3):
                out[a, k, l] = held[a, k, l] if exact == 1.0 else held[k, a, l]
    x[:] = 0.0
    v[:] = 0.0
    inner[:] = 0.0
    for k in range(m):
        slope = RT / D0[i, k] * (J[i] * dkdJ[i, k] - kappa[i, k])
        for a in range(3):
            x[a] += slope * Dg[k, a]
            v[a] += RT * kappa[i, k] / D0[i, k] * Dg[k, a]
        if dD.shape[0] > 0:
            strained(gc[i, k], dD[i, k], RT * kappa[i, k] / D0[i, k], inner)
    apply(Ke, x, y)
    for a in range(3):
        for k in range(3):
            out[a, k, k] -= y[a]
    pair(Ke, v, -1.0, 2.0 - exact, out)
    if dD.shape[0] > 0:
        contract(Ke, inner, -1.0, out)


@kernel
def by_concentration(i, RT, phi, D0, kappa, ca, c, dkdc, Dc, D0c, gc, Ke, D, Dg, w, out):
    """The change of w by the values of the concentrations, of point ``i``: out (m, 3)."""
    m = D0.shape[1]
    Dw, y, total = np.empty((m, 3)), np.empty(3), np.empty(3)
    for k in range(m):
        apply(D[k], w, Dw[k])
    for n in range(m):
        total[:] = 0.0
        for k in range(m):
            ratio = (dkdc[i, k, n] - kappa[i, k] / D0[i, k] * D0c[i, k, n]) / D0[i, k]
            drag = c[i, k] * ratio
            if k == n:
                drag += kappa[i, k] / D0[i, k]
            for a in range(3):
                total[a] -= RT / phi[i] * drag * (w[a] - Dw[k, a] / D0[i, k]) + RT * ratio * Dg[k, a]
            if Dc.shape[0] > 0:
                apply_voigt(Dc[i, k, n], w, y)
                for a in range(3):
                    changed = y[a] / D0[i, k] - Dw[k, a] / D0[i, k] * D0c[i, k, n] / D0[i, k]
                    total[a] += RT / phi[i] * ca[i, k] / D0[i, k] * changed
                apply_voigt(Dc[i, k, n], gc[i, k], y)
                for a in range(3):
                    total[a] -= RT * kappa[i, k] / D0[i, k] * y[a]
        apply(Ke, total, out[n])


@kernel
def apply_voigt(d, v, out):
    """out = d v of Voigt's columns d (6,)."""
    for a in range(3):
        out[a] = d[VOIGT[a, 0]] * v[0] + d[VOIGT[a, 1]] * v[1] + d[VOIGT[a, 2]] * v[2]
