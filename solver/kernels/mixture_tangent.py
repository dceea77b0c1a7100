"""The tangent of a mixture at points (what it is: :mod:`..multiphasic.tangent`).

Arrays are those of :mod:`.mixture_flow`; dK (n|0, 6, 6), dD (n|0, m, 6, 6) strain tangents of permeability and
diffusivities, Dc (n|0, m, m, 6), D0c (n, m, m) slopes of diffusivities by c, dkdJ (n, m), dkdc (n, m, m) those of the
partition coefficients; without rows where they vanish. A (n, 4, C, C, 4).
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from .mixture_flow import apply, conduct
from .mixture_flow_tangent import (
    VOIGT,
    apply_voigt,
    by_concentration,
    by_displacement,
    contract,
    pair,
    strained,
)


@kernel
def add_pressure(C, pressure, slope):
    """Add to a solid's tangent C (n, 6, 6) that of -p I, with J dp/dJ = ``slope``."""
    for i in range(len(pressure)):
        for a in range(3):
            C[i, a, a] += 2.0 * pressure[i]
            C[i, 3 + a, 3 + a] += pressure[i]
            for b in range(3):
                C[i, a, b] -= pressure[i] + slope[i]


@kernel
def solid(s, pressure, C, by_c, A):
    """Rows of displacements: s (n, 6) the solid's stress, C (n, 6, 6) of all, by_c (n, m) slopes of the pressure."""
    for i in range(len(s)):
        T = A[i]
        T[:] = 0.0
        for a in range(3):
            for b in range(3):
                x = s[i, VOIGT[a, b]] - (pressure[i] if a == b else 0.0)
                for k in range(3):
                    for l in range(3):
                        T[1 + b, a, k, 1 + l] += C[i, VOIGT[a, b], VOIGT[k, l]]
                    T[1 + b, k, k, 1 + a] += x
            T[1 + a, a, 3, 0] = -1.0
            for k in range(by_c.shape[1]):
                T[1 + a, a, 4 + k, 0] = -by_c[i, k]


@kernel
def fluid(i, dt, steady, RT, D0, kappa, Ke, D, wu, wv, wg, pe, pp, pc, T):
    """Row of the pressure; wg (m, 3, 3) is what grad c does to w. pe, pp, pc: slopes of the supply of fluid."""
    for a in range(3):
        for k in range(3):
            for l in range(3):
                T[1 + a, 3, k, 1 + l] = dt * wu[a, k, l]
            T[1 + a, 3, 3, 1 + k] = -dt * Ke[a, k]
        T[0, 3, a, 1 + a] = dt * pe[i] - (0.0 if steady else 1.0)
    T[0, 3, 3, 0] = dt * pp[i]
    for n in range(D0.shape[1]):
        f = -RT * kappa[i, n] / D0[i, n]
        T[0, 3, 4 + n, 0] = dt * pc[i, n]
        for a in range(3):
            T[1 + a, 3, 4 + n, 0] = dt * wv[n, a]
            for b in range(3):
                wg[n, a, b] = f * (Ke[a, 0] * D[n, 0, b] + Ke[a, 1] * D[n, 1, b] + Ke[a, 2] * D[n, 2, b])
                T[1 + a, 3, 4 + n, 1 + b] = dt * wg[n, a, b]


@kernel
def flux(i, k, exact, J, phi, D0, kappa, ca, c, dkdJ, dkdc, gc, dD, Dc, D0c, Ke, D, Dg, w, wu, wv, wg, T):
    """What changes the flux of solute ``k``, without the time step."""
    row, m, carried = 4 + k, D0.shape[1], ca[i, k] / D0[i, k]
    Dw, driven, M, y, ju = np.empty(3), np.empty(3), np.empty((3, 3)), np.empty(3), np.zeros((3, 3, 3))
    apply(D[k], w, Dw)
    for a in range(3):
        driven[a] = c[i, k] / D0[i, k] * w[a] - phi[i] * gc[i, k, a]
        for b in range(3):
            M[a, b] = carried * D[k, a, b]
    pair(M, w, 1.0, 2.0 - exact, ju)
    contract(M, wu, 1.0, ju)
    if dD.shape[0] > 0:
        strained(driven, dD[i, k], kappa[i, k], ju)
    for a in range(3):
        g = c[i, k] / D0[i, k] * Dw[a] - phi[i] * Dg[k, a]
        along = J[i] * dkdJ[i, k] * g - carried * Dw[a] - kappa[i, k] * (1.0 - phi[i]) * Dg[k, a]
        for b in range(3):
            ju[a, b, b] += along
            T[1 + a, row, 3, 1 + b] = -(M[a, 0] * Ke[0, b] + M[a, 1] * Ke[1, b] + M[a, 2] * Ke[2, b])
            for l in range(3):
                T[1 + a, row, b, 1 + l] = ju[a, b, l]
        for n in range(m):
            x = M[a, 0] * wv[n, 0] + M[a, 1] * wv[n, 1] + M[a, 2] * wv[n, 2]
            x += dkdc[i, k, n] * g - carried * D0c[i, k, n] / D0[i, k] * Dw[a]
            T[1 + a, row, 4 + n, 0] = x + (kappa[i, k] / D0[i, k] * Dw[a] if n == k else 0.0)
            for b in range(3):
                x = M[a, 0] * wg[n, 0, b] + M[a, 1] * wg[n, 1, b] + M[a, 2] * wg[n, 2, b]
                T[1 + a, row, 4 + n, 1 + b] = x - (kappa[i, k] * phi[i] * D[k, a, b] if n == k else 0.0)
    if Dc.shape[0] > 0:
        for n in range(m):
            apply_voigt(Dc[i, k, n], driven, y)
            for a in range(3):
                T[1 + a, row, 4 + n, 0] += kappa[i, k] * y[a]


@kernel
def balance(dt, weight, T):
    """The fluxes' rows, dt (j_k + sum_n weight_n j_n)."""
    C = T.shape[1]
    for a in range(1, 4):
        for s in range(C):
            for b in range(1 if s < 3 else 0, 4):
                current = 0.0
                for n in range(4, C):
                    current += weight[n - 4] * T[a, n, s, b]
                for n in range(4, C):
                    T[a, n, s, b] = dt * (T[a, n, s, b] + current)


@kernel
def stored(i, dt, steady, J, phi, kappa, c, dkdJ, dkdc, made_u, made_c, T):
    """What is made (its slopes by volume (n, m) and c (n, m, m)) and stored of the solutes."""
    for k in range(kappa.shape[1]):
        u = dt * made_u[i, k]
        if not steady:
            u -= c[i, k] * (kappa[i, k] + J[i] * phi[i] * dkdJ[i, k])
        for a in range(3):
            T[0, 4 + k, a, 1 + a] = u
        for n in range(kappa.shape[1]):
            x = c[i, k] * dkdc[i, k, n] + (kappa[i, k] if n == k else 0.0)
            T[0, 4 + k, 4 + n, 0] = dt * made_c[i, k, n] - (0.0 if steady else phi[i] * x)


@kernel
def flows(
    dt, steady, exact, RT, J, phi, K, D, D0, kappa, ca, c, dkdJ, dkdc, gp, gc, dK, dD, Dc, D0c, pe, pp, pc,
    weight, made_u, made_c, A,
):  # fmt: skip
    """Rows of the pressure and the concentrations."""
    m = D0.shape[1]
    Ki, Ke, Di, Dg, w = np.empty((3, 3)), np.empty((3, 3)), np.empty((m, 3, 3)), np.empty((m, 3)), np.empty(3)
    wu, wv, wg = np.empty((3, 3, 3)), np.empty((m, 3)), np.empty((m, 3, 3))
    for i in range(len(J)):
        conduct(i, RT, phi, K, D, D0, kappa, ca, gp, gc, Ki, Ke, Di, Dg, w)
        by_displacement(i, RT, exact, J, phi, D0, kappa, ca, c, dkdJ, gc, dK, dD, Ki, Ke, Di, Dg, w, wu)
        by_concentration(i, RT, phi, D0, kappa, ca, c, dkdc, Dc, D0c, gc, Ke, Di, Dg, w, wv)
        fluid(i, dt, steady, RT, D0, kappa, Ke, Di, wu, wv, wg, pe, pp, pc, A[i])
        for k in range(m):
            flux(
                i,
                k,
                exact,
                J,
                phi,
                D0,
                kappa,
                ca,
                c,
                dkdJ,
                dkdc,
                gc,
                dD,
                Dc,
                D0c,
                Ke,
                Di,
                Dg,
                w,
                wu,
                wv,
                wg,
                A[i],
            )
        balance(dt, weight, A[i])
        stored(i, dt, steady, J, phi, kappa, c, dkdJ, dkdc, made_u, made_c, A[i])
