"""Contact by a potential of the distance between points of two surfaces: tractions and tangents.

Facets e of one surface and f of the other act on each other where ``first`` and ``second`` (k,) pair them; a, b stand
for the surfaces: points (q, 3), ``w`` their current areas (q,), ``start`` (facet + 1,) the first point of each facet,
N (q, 9). law (6,): k, p, R_in, R_out, c1, c2 of :func:`slope`. Source: Kamensky, Xu, Lee, Yan, Bazilevs and Hsu, Comput
Methods Appl Mech Engrg 330 (2018) 522; FEBio User Manual, "Contact potential".
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel


@kernel
def slope(law, r):
    """Minus the potential's slope: k / r^p - c2 below R_in, c1 (r - R_out)^2 below R_out, 0 beyond."""
    if r < law[2]:
        return law[0] / r ** law[1] - law[5]
    return law[4] * (r - law[3]) ** 2 if r < law[3] else 0.0


@kernel
def _bend(law, r):
    """Slope of :func:`slope`."""
    if r < law[2]:
        return -law[1] * law[0] / r ** (law[1] + 1.0)
    return 2.0 * law[4] * (r - law[3]) if r < law[3] else 0.0


@kernel
def tractions(law, first, second, xa, wa, starta, xb, wb, startb, ta, tb):
    """Add the tractions (q, 3) at the points of both surfaces."""
    d = np.empty(3)
    for k in range(len(first)):
        e, f = first[k], second[k]
        for i in range(starta[e], starta[e + 1]):
            for j in range(startb[f], startb[f + 1]):
                for c in range(3):
                    d[c] = xa[i, c] - xb[j, c]
                r = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
                if r >= law[3]:
                    continue
                s = slope(law, r) / r
                for c in range(3):
                    ta[i, c] += s * d[c] * wb[j]
                    tb[j, c] -= s * d[c] * wa[i]


@kernel
def stiffness(law, rows, first, second, xa, wa, starta, Na, na, xb, wb, startb, Nb, nb, K):
    """K (rows, d, d) += tangent of pairs of facets of na and nb nodes; areas are held, as in FEBio."""
    d, W, M = np.empty(3), np.empty(18), np.empty((3, 3))
    for m in range(len(rows)):
        e, f = first[rows[m]], second[rows[m]]
        for i in range(starta[e], starta[e + 1]):
            for j in range(startb[f], startb[f + 1]):
                for c in range(3):
                    d[c] = xa[i, c] - xb[j, c]
                r = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
                if r >= law[3]:
                    continue
                s, area = slope(law, r) / r, wa[i] * wb[j]
                h = (_bend(law, r) - s) / (r * r)
                for c in range(3):
                    for g in range(3):
                        M[c, g] = -area * (h * d[c] * d[g] + (s if c == g else 0.0))
                for a in range(na):
                    W[a] = Na[i, a]
                for b in range(nb):
                    W[na + b] = -Nb[j, b]
                for a in range(na + nb):
                    for b in range(na + nb):
                        for c in range(3):
                            for g in range(3):
                                K[m, 3 * a + c, 3 * b + g] += W[a] * W[b] * M[c, g]
