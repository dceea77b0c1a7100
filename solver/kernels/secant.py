"""Tangents from differences of a stress: the states it is asked for, and what its answers make."""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from .push import congruence
from .tensors import eigen, right_cauchy_green


@kernel
def stretched(F, eps, U, Ui, J):
    """Stretches U, their inverses (7 n, 3, 3) and determinants (7 n,) of C = F^T F and of C with E_kl more by eps."""
    a, A, w, V = np.empty(6), np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    for i in range(len(F)):
        for m in range(7):
            right_cauchy_green(F, i, 1.0, a)
            if m > 0:
                a[m - 1] += 2.0 * eps if m < 4 else eps
            eigen(a, A, w, V)
            j = 7 * i + m
            for k in range(3):
                w[k] = math.sqrt(w[k])
            J[j] = w[0] * w[1] * w[2]
            for r in range(3):
                for c in range(3):
                    x = y = 0.0
                    for k in range(3):
                        x += V[r, k] * w[k] * V[c, k]
                        y += V[r, k] / w[k] * V[c, k]
                    U[j, r, c], Ui[j, r, c] = x, y


@kernel
def pushed(A, s, out):
    """out[m] = A s[m] A^T for symmetric s (6, 6), row by row."""
    for i in range(6):
        xx, yy, zz, xy, yz, xz = s[i, 0], s[i, 1], s[i, 2], s[i, 3], s[i, 4], s[i, 5]
        for m in range(6):
            p = m if m < 3 else (0 if m != 4 else 1)
            q = m if m < 3 else (1 if m == 3 else 2)
            a, b, c = A[p, 0], A[p, 1], A[p, 2]
            d, e, f = A[q, 0], A[q, 1], A[q, 2]
            out[i, m] = (
                a * (xx * d + xy * e + xz * f) + b * (xy * d + yy * e + yz * f) + c * (xz * d + yz * e + zz * f)
            )


@kernel
def add_differences(s, Ui, J, F, eps, S, c):
    """Add to c (n, 6, 6) the tangent of stresses s (7 n, 6) in the states of :func:`stretched`; S (7 n, 6) scratch.

    dS/dE of S = J U^-1 s U^-1, pushed forward by F (n, 3, 3) and divided by J of the first state.
    """
    D, X = np.empty((6, 6)), np.empty((6, 6))
    congruence(Ui, J, s, S)
    for i in range(len(c)):
        for m in range(6):
            for k in range(6):
                D[m, k] = (S[7 * i + m + 1, k] - S[7 * i, k]) / eps
        pushed(F[i], D, X)  # the stresses, strain by strain; then the strains
        for m in range(6):
            for k in range(6):
                D[k, m] = X[m, k]
        pushed(F[i], D, X)
        for m in range(6):
            for k in range(6):
                c[i, m, k] += X[m, k] / J[7 * i]
