"""Polynomial pressure projection: what steadies equal-order elements below the Vermeer-Verruijt step.

Adds -c sum_q (N - Pi N)(dp - Pi dp) w0 to the rows of p, Pi the mean over the element, dp the change of p over the
step. c = tau max(1 / (2 G), 3 / H): the first keeps nearly incompressible solids stable (White and Borja, Comput
Methods Appl Mech Engrg 197 (2008) 4353; Bochev, Dohrmann and Gunzburger, SIAM J Numer Anal 44 (2006) 82); with the
second, H the aggregate modulus, the storage of confined linear elements is that of a lumped mass, whose pressures stay
within bounds at any step.
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel


@kernel
def _mean_shapes(e, N, w0, mean):
    """Means of the shape functions over element e."""
    total = 0.0
    mean[:] = 0.0
    for g in range(N.shape[0]):
        total += w0[e, g]
        for a in range(N.shape[1]):
            mean[a] += w0[e, g] * N[g, a]
    for a in range(N.shape[1]):
        mean[a] /= total


@kernel
def force(lo, hi, conn, N, w0, c, p, p_old, R):
    """Subtract the projection's force of elements lo:hi from R (node,); c (m,), p and p_old (m, g)."""
    ng, nen = N.shape
    mean = np.empty(nen)
    for e in range(lo, hi):
        _mean_shapes(e, N, w0, mean)
        total = dp = 0.0
        for g in range(ng):
            total += w0[e, g]
            dp += w0[e, g] * (p[e, g] - p_old[e, g])
        dp /= total
        for g in range(ng):
            v = c[e] * w0[e, g] * (p[e, g] - p_old[e, g] - dp)
            for a in range(nen):
                R[conn[e, a]] += v * (N[g, a] - mean[a])


@kernel
def tangent(lo, hi, N, w0, c, M, at, to):
    """Add its tangent to M (hi - lo, ., .), whose block of the pressure starts at row ``at`` and column ``to``."""
    ng, nen = N.shape
    mean = np.empty(nen)
    for e in range(lo, hi):
        _mean_shapes(e, N, w0, mean)
        K = M[e - lo]
        for g in range(ng):
            v = -c[e] * w0[e, g]
            for a in range(nen):
                x = v * (N[g, a] - mean[a])
                for b in range(nen):
                    K[at + a, to + b] += x * (N[g, b] - mean[b])
