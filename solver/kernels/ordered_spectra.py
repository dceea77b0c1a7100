"""Eigenvectors of symmetric 3 x 3 matrices by Householder's reduction and QL, with the signs these give.

Where a quadrature is laid along eigenvectors, its directions depend on their signs and on the choice among equal
eigenvalues; FEBio takes those of this method. Bowdler, Martin, Reinsch & Wilkinson, Numer. Math. 11 (1968) 293
(EISPACK's tred2 and tql2).
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel


@kernel
def _tridiagonal(V, d, e):
    """Reduce V (3, 3) to diagonal d and subdiagonal e[1:]; V becomes the transformation."""
    for j in range(3):
        d[j] = V[2, j]
    for i in (2, 1):
        scale = 0.0
        for k in range(i):
            scale += abs(d[k])
        h = 0.0
        if scale == 0.0:
            e[i] = d[i - 1]
            for j in range(i):
                d[j] = V[i - 1, j]
                V[i, j] = V[j, i] = 0.0
        else:
            for k in range(i):
                d[k] /= scale
                h += d[k] * d[k]
            f = d[i - 1]
            g = -np.sqrt(h) if f > 0.0 else np.sqrt(h)
            e[i] = scale * g
            h -= f * g
            d[i - 1] = f - g
            for j in range(i):
                e[j] = 0.0
            for j in range(i):
                f = d[j]
                V[j, i] = f
                g = e[j] + V[j, j] * f
                for k in range(j + 1, i):
                    g += V[k, j] * d[k]
                    e[k] += V[k, j] * f
                e[j] = g
            f = 0.0
            for j in range(i):
                e[j] /= h
                f += e[j] * d[j]
            half = f / (h + h)
            for j in range(i):
                e[j] -= half * d[j]
            for j in range(i):
                f, g = d[j], e[j]
                for k in range(j, i):
                    V[k, j] -= f * e[k] + g * d[k]
                d[j] = V[i - 1, j]
                V[i, j] = 0.0
        d[i] = h
    for i in range(2):
        V[2, i] = V[i, i]
        V[i, i] = 1.0
        h = d[i + 1]
        if h != 0.0:
            for k in range(i + 1):
                d[k] = V[k, i + 1] / h
            for j in range(i + 1):
                g = 0.0
                for k in range(i + 1):
                    g += V[k, i + 1] * V[k, j]
                for k in range(i + 1):
                    V[k, j] -= g * d[k]
        for k in range(i + 1):
            V[k, i + 1] = 0.0
    for j in range(3):
        d[j] = V[2, j]
        V[2, j] = 0.0
    V[2, 2] = 1.0
    e[0] = 0.0


@kernel
def _implicit_shifts(V, d, e):
    """Diagonalise the tridiagonal matrix (d, e[1:]) by QL, turning the columns of V along."""
    eps = 2.0**-52
    e[0], e[1], e[2] = e[1], e[2], 0.0
    shift = largest = 0.0
    for l in range(3):
        largest = max(largest, abs(d[l]) + abs(e[l]))
        m = l
        while m < 2 and abs(e[m]) > eps * largest:
            m += 1
        rounds = 0
        while m > l and rounds < 60:
            rounds += 1
            g = d[l]
            p = (d[l + 1] - g) / (2.0 * e[l])
            r = np.sqrt(p * p + 1.0)
            r = -r if p < 0.0 else r
            d[l] = e[l] / (p + r)
            d[l + 1] = e[l] * (p + r)
            next_d, next_e = d[l + 1], e[l + 1]
            h = g - d[l]
            for i in range(l + 2, 3):
                d[i] -= h
            shift += h
            p = d[m]
            c = c2 = c3 = 1.0
            s = s2 = 0.0
            for i in range(m - 1, l - 1, -1):
                c3, c2, s2 = c2, c, s
                g, h = c * e[i], c * p
                r = np.sqrt(p * p + e[i] * e[i])
                e[i + 1] = s * r
                s, c = e[i] / r, p / r
                p = c * d[i] - s * g
                d[i + 1] = h + s * (c * g + s * d[i])
                for k in range(3):
                    h = V[k, i + 1]
                    V[k, i + 1] = s * V[k, i] + c * h
                    V[k, i] = c * V[k, i] - s * h
            p = -s * s2 * c3 * next_e * e[l] / next_d
            e[l] = s * p
            d[l] = c * p
            if not abs(e[l]) > eps * largest:
                break
        d[l] += shift
        e[l] = 0.0


@kernel
def ordered_spectra(A, values, vectors):
    """Eigenvalues (n, 3), ascending, and vectors (n, 3, 3; columns) of symmetric A (n, 3, 3)."""
    e = np.empty(3)
    for q in range(len(A)):
        V, d = vectors[q], values[q]
        for i in range(3):
            for j in range(3):
                V[i, j] = A[q, i, j]
        _tridiagonal(V, d, e)
        _implicit_shifts(V, d, e)
        for i in range(2):
            k = i
            for j in range(i + 1, 3):
                if d[j] < d[k]:
                    k = j
            if k != i:
                d[i], d[k] = d[k], d[i]
                for p in range(3):
                    V[p, i], V[p, k] = V[p, k], V[p, i]
