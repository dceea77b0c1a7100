"""Dilatational stiffness of the three-field element: k / V0 (int grad N)(int grad N)^T."""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from .solid import gradients


@kernel
def dilatation(lo, hi, dN, iJ0, wJ0, F, J, k, K):
    """Add to K (hi - lo, 3n, 3n) the stiffness of the element-mean pressure.

    k (hi - lo,) = U''(mean J) + multiplier terms. Source: Simo, Taylor and Pister, Comput Methods Appl
    Mech Engrg 51 (1985), the mean-dilatation element.
    """
    n = dN.shape[1]
    G, B = np.empty((3, n)), np.empty((3, n))
    for e in range(lo, hi):
        M = K[e - lo]
        B[:] = 0.0
        V = 0.0
        for g in range(dN.shape[0]):
            gradients(F[e, g], J[e, g], iJ0[e, g], dN[g], G)
            w = wJ0[e, g] * J[e, g]
            V += wJ0[e, g]
            for i in range(3):
                for a in range(n):
                    B[i, a] += G[i, a] * w
        q = k[e - lo] / V
        for i in range(3):
            for a in range(n):
                x = B[i, a] * q
                for j in range(3):
                    for b in range(n):
                        M[i * n + a, j * n + b] += x * B[j, b]
