"""Prony series of an elastic stress, point by point."""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel


@kernel
def prony(F, J, se, par, dt, at, old, new, s, scale):
    """Add the stress of :class:`..solids.viscoelastic.Viscoelastic` to s (n, 6); scale (n,) of the elastic tangent.

    se (n, 6) the elastic Cauchy stress; par (1|n, 2 m + 1): g0 ... gm, t1 ... tm; old, new (n, columns): second
    Piola-Kirchhoff stresses Se, H1 ... Hm from column ``at``; ``new`` is left alone where it has no rows.
    """
    terms = (par.shape[1] - 1) // 2
    A, T, S = np.empty((3, 3)), np.empty((3, 3)), np.empty(6)
    fade, grow = np.empty(terms), np.empty(terms)  # exp(-x) and (exp(-x) - 1) / x, x = dt / t
    P, Q = np.array([0, 1, 2, 0, 1, 0]), np.array([0, 1, 2, 1, 2, 2])
    for i in range(len(J)):
        m = i if par.shape[0] > 1 else 0
        f, k = F[i], 1.0 / J[i]
        # the inverse of F from its cofactors
        for r in range(3):
            r1, r2 = (r + 1) % 3, (r + 2) % 3
            for c in range(3):
                c1, c2 = (c + 1) % 3, (c + 2) % 3
                A[c, r] = (f[r1, c1] * f[r2, c2] - f[r1, c2] * f[r2, c1]) * k
        T[0, 0], T[1, 1], T[2, 2] = se[i, 0], se[i, 1], se[i, 2]
        T[0, 1] = T[1, 0] = se[i, 3]
        T[1, 2] = T[2, 1] = se[i, 4]
        T[0, 2] = T[2, 0] = se[i, 5]
        if i == 0 or par.shape[0] > 1:
            for j in range(terms):
                x = dt / par[m, terms + 1 + j]
                fade[j], grow[j] = math.exp(-x), math.expm1(-x) / x
        scale[i] = par[m, 0]
        for v in range(6):
            p, q = P[v], Q[v]
            Se = 0.0
            for a in range(3):
                for b in range(3):
                    Se += A[p, a] * T[a, b] * A[q, b]
            Se *= J[i]
            S[v] = par[m, 0] * Se
            rate = Se - old[i, at + v]
            if len(new) > 0:
                new[i, at + v] = Se
            for j in range(terms):
                w = at + 6 * (j + 1) + v
                H = fade[j] * old[i, w] - grow[j] * rate
                S[v] += par[m, j + 1] * H
                if len(new) > 0:
                    new[i, w] = H
        for j in range(terms):
            scale[i] -= par[m, j + 1] * grow[j]
        T[0, 0], T[1, 1], T[2, 2] = S[0], S[1], S[2]
        T[0, 1] = T[1, 0] = S[3]
        T[1, 2] = T[2, 1] = S[4]
        T[0, 2] = T[2, 0] = S[5]
        for v in range(6):
            p, q = P[v], Q[v]
            for a in range(3):
                for b in range(3):
                    s[i, v] += f[p, a] * T[a, b] * f[q, b] * k
