"""Permeability tensors and their strain tangents at batches of points."""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from .tensors import add_circles, add_identity, dyad_of, left_cauchy_green, symmetric_product


@kernel
def isotropic(k, Jk, K, dK):
    """K = k I with J dk/dJ = Jk (both (1|n,)): D = (k + J k') I dyad I - 2 k I circle I."""
    for i in range(K.shape[0]):
        m = i if len(k) > 1 else 0
        for a in range(3):
            K[i, a] += k[m]
        if dK.shape[0] > 0:
            add_identity(dK, i, k[m] + Jk[m], -2.0 * k[m])


@kernel
def _scale(perm, M, alpha, J, phi):
    """perm ((J - phi) / (1 - phi))^alpha exp(M (J^2 - 1) / 2)."""
    if perm == 0.0:
        return 0.0
    f = perm * math.exp(0.5 * M * (J * J - 1.0))
    return f * math.pow((J - phi) / (1.0 - phi), alpha) if alpha != 0.0 else f


@kernel
def _add_dyad_with_identity(dK, i, k, a):
    """k (a dyad I)."""
    for p in range(6):
        for q in range(3):
            dK[i, p, q] += k * a[p]


@kernel
def referential(F, J, phi, Q, par, K, dK):
    """K = k0 I + sum_a [k1_a m_a + k2_a (m_a b + b m_a)], m_a = (F q_a) dyad (F q_a), q_a the columns of Q.

    par (1|n, 15): perm0, M0, alpha0, then perm1, perm2, M, alpha for the three axes; with
    s(perm, M, alpha) = perm ((J - phi) / (1 - phi))^alpha exp(M (J^2 - 1) / 2) the coefficients are
    k0 = s_0, k1_a = s(perm1_a) / J^2, k2_a = s(perm2_a) / (2 J^4).
    Ateshian & Weiss, J. Biomech. Eng. 132 (2010) 111004.
    """
    b = np.empty(6)
    m = np.empty(6)
    mb = np.empty(6)
    for i in range(len(J)):
        r = par[i if par.shape[0] > 1 else 0]
        f = phi[i if len(phi) > 1 else 0]
        q = Q[i if Q.shape[0] > 1 else 0]
        j = J[i]
        left_cauchy_green(F, i, 1.0, b)
        k0 = _scale(r[0], r[1], r[2], j, f)
        for c in range(3):
            K[i, c] += k0
        if dK.shape[0] > 0:
            slope = j * j * r[1] + r[2] * j / (j - f)
            add_identity(dK, i, k0 * (1.0 + slope), -2.0 * k0)
        for a in range(3):
            k1 = _scale(r[3 + a], r[9 + a], r[12 + a], j, f) / (j * j)
            k2 = _scale(r[6 + a], r[9 + a], r[12 + a], j, f) / (2.0 * j**4)
            if k1 == 0.0 and k2 == 0.0:
                continue
            x = F[i, 0, 0] * q[0, a] + F[i, 0, 1] * q[1, a] + F[i, 0, 2] * q[2, a]
            y = F[i, 1, 0] * q[0, a] + F[i, 1, 1] * q[1, a] + F[i, 1, 2] * q[2, a]
            z = F[i, 2, 0] * q[0, a] + F[i, 2, 1] * q[1, a] + F[i, 2, 2] * q[2, a]
            dyad_of(x, y, z, m)
            symmetric_product(m, b, mb)
            for c in range(6):
                K[i, c] += k1 * m[c] + 2.0 * k2 * mb[c]
            if dK.shape[0] > 0:
                # m and b are convected, so only J and the b between two of them leave a rate
                slope = j * j * r[9 + a] + r[12 + a] * j / (j - f)
                _add_dyad_with_identity(dK, i, k1 * (slope - 1.0), m)
                _add_dyad_with_identity(dK, i, 2.0 * k2 * (slope - 3.0), mb)
                add_circles(dK, i, 2.0 * k2, m, b)
