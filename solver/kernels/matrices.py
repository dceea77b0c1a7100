"""Stacks of 3 x 3 matrices: inverses, determinants, eigenvalues."""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from .tensors import eigen


@kernel
def determinants(A, out):
    """det of A (n, 3, 3)."""
    for i in range(len(A)):
        out[i] = (
            A[i, 0, 0] * (A[i, 1, 1] * A[i, 2, 2] - A[i, 1, 2] * A[i, 2, 1])
            - A[i, 0, 1] * (A[i, 1, 0] * A[i, 2, 2] - A[i, 1, 2] * A[i, 2, 0])
            + A[i, 0, 2] * (A[i, 1, 0] * A[i, 2, 1] - A[i, 1, 1] * A[i, 2, 0])
        )


@kernel
def inverses(A, out):
    """A^-1 of A (n, 3, 3); infinite where A is singular."""
    for i in range(len(A)):
        c0 = A[i, 1, 1] * A[i, 2, 2] - A[i, 1, 2] * A[i, 2, 1]
        c1 = A[i, 1, 2] * A[i, 2, 0] - A[i, 1, 0] * A[i, 2, 2]
        c2 = A[i, 1, 0] * A[i, 2, 1] - A[i, 1, 1] * A[i, 2, 0]
        d = 1.0 / (A[i, 0, 0] * c0 + A[i, 0, 1] * c1 + A[i, 0, 2] * c2)
        out[i, 0, 0], out[i, 1, 0], out[i, 2, 0] = c0 * d, c1 * d, c2 * d
        out[i, 0, 1] = (A[i, 0, 2] * A[i, 2, 1] - A[i, 0, 1] * A[i, 2, 2]) * d
        out[i, 1, 1] = (A[i, 0, 0] * A[i, 2, 2] - A[i, 0, 2] * A[i, 2, 0]) * d
        out[i, 2, 1] = (A[i, 0, 1] * A[i, 2, 0] - A[i, 0, 0] * A[i, 2, 1]) * d
        out[i, 0, 2] = (A[i, 0, 1] * A[i, 1, 2] - A[i, 0, 2] * A[i, 1, 1]) * d
        out[i, 1, 2] = (A[i, 0, 2] * A[i, 1, 0] - A[i, 0, 0] * A[i, 1, 2]) * d
        out[i, 2, 2] = (A[i, 0, 0] * A[i, 1, 1] - A[i, 0, 1] * A[i, 1, 0]) * d


@kernel
def spectra(S, values, vectors):
    """Eigenvalues (n, 3), ascending, and vectors (n, 3, 3; columns) of symmetric S (n, 3, 3), lower triangle."""
    a, A, w, V = np.empty(6), np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    for i in range(len(S)):
        a[0], a[1], a[2] = S[i, 0, 0], S[i, 1, 1], S[i, 2, 2]
        a[3], a[4], a[5] = S[i, 1, 0], S[i, 2, 1], S[i, 2, 0]
        eigen(a, A, w, V)
        x = 0 if w[0] <= w[1] and w[0] <= w[2] else 1 if w[1] <= w[2] else 2
        z = 2 if w[2] >= w[0] and w[2] >= w[1] else 1 if w[1] >= w[0] else 0
        order = (x, 3 - x - z, z)
        for k in range(3):
            values[i, k] = w[order[k]]
            for p in range(3):
                vectors[i, p, k] = V[p, order[k]]
