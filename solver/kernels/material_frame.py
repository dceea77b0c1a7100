"""Push forward from local material axes to space."""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from .tensors import add_deviatoric_stress, add_deviatoric_tangent


@kernel
def strain_in_frame(F, Q, iso, J, E):
    """E (n, 6) = Q^T (F^T F - I) Q / 2 in local axes ``Q`` (1|n, 3, 3); of F~ where ``iso``. Also for shear E_ij."""
    A = np.empty((3, 3))
    for i in range(len(J)):
        m = i if Q.shape[0] > 1 else 0
        k = J[i] ** (-1.0 / 3.0) if iso else 1.0
        for p in range(3):
            for q in range(3):
                A[p, q] = k * (F[i, p, 0] * Q[m, 0, q] + F[i, p, 1] * Q[m, 1, q] + F[i, p, 2] * Q[m, 2, q])
        for a in range(6):
            p = a if a < 3 else (1 if a == 4 else 0)
            q = a if a < 3 else (1 if a == 3 else 2)
            C = A[0, p] * A[0, q] + A[1, p] * A[1, q] + A[2, p] * A[2, q]
            E[i, a] = 0.5 * (C - 1.0) if a < 3 else 0.5 * C


@kernel
def push_frame(F, Q, iso, J, S, D, s, c):
    """s[i] = A S A^T and c[i] = (A x A) D (A x A)^T with A = F Q (F~ where ``iso``); no division by J.

    ``S`` (n, 6) and ``D`` (n, 6, 6) are a stress and its derivative by E in local axes.
    """
    A, T, G = np.empty((3, 3)), np.empty((6, 6)), np.empty((6, 6))
    for i in range(len(J)):
        m = i if Q.shape[0] > 1 else 0
        k = J[i] ** (-1.0 / 3.0) if iso else 1.0
        for p in range(3):
            for q in range(3):
                A[p, q] = k * (F[i, p, 0] * Q[m, 0, q] + F[i, p, 1] * Q[m, 1, q] + F[i, p, 2] * Q[m, 2, q])
        for a in range(6):
            p = a if a < 3 else (1 if a == 4 else 0)
            q = a if a < 3 else (1 if a == 3 else 2)
            for r in range(3):
                T[a, r] = A[p, r] * A[q, r]
            T[a, 3] = A[p, 0] * A[q, 1] + A[p, 1] * A[q, 0]
            T[a, 4] = A[p, 1] * A[q, 2] + A[p, 2] * A[q, 1]
            T[a, 5] = A[p, 0] * A[q, 2] + A[p, 2] * A[q, 0]
        for a in range(6):
            s[i, a] = 0.0
            for b in range(6):
                s[i, a] += T[a, b] * S[i, b]
        if c.shape[0] == 0:
            continue
        for a in range(6):
            for b in range(6):
                g = 0.0
                for r in range(6):
                    g += T[a, r] * D[i, r, b]
                G[a, b] = g
        for a in range(6):
            for b in range(6):
                g = 0.0
                for r in range(6):
                    g += G[a, r] * T[b, r]
                c[i, a, b] = g


@kernel
def add_projected(J, T, h, iso, s, c):
    """Add T / J and h / J, or their deviatoric parts where ``iso`` (T and h being of F~)."""
    one = np.empty((1, 6, 6))
    for i in range(len(J)):
        Ji = 1.0 / J[i]
        if iso:
            add_deviatoric_stress(s, i, Ji, T[i])
        for p in range(6):
            if not iso:
                s[i, p] += Ji * T[i, p]
            if c.shape[0] > 0:
                for q in range(6):
                    one[0, p, q] = h[i, p, q]
                    if not iso:
                        c[i, p, q] += Ji * h[i, p, q]
        if iso and c.shape[0] > 0:
            add_deviatoric_tangent(c, i, Ji, T[i], one)
