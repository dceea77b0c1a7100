"""Symmetric element tangents as products of small matrices.

The block (i, j) of an element's displacement tangent is sum over points q and directions r of
T_ij[q, r, a] grad_r N_b with T_ij[q, r, a] = sum_k (D[ik, jr] + delta_ij s_kr) grad_k N_a w; that of the pressure
has T = -dt w K grad N_a. So all blocks i <= j of an element are one product of two matrices, which a BLAS does
faster than loops; the kernels here make its factors. Bathe, Finite Element Procedures (1996), section 6.3.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from ..jit import kernel
from .solid import inverse_map


@lru_cache(maxsize=None)
def factors(nen: int, fluid: bool) -> Callable[..., Any]:
    """The kernel that makes the factors for elements of ``nen`` nodes (fixed, so that its loops vectorise)."""
    R = (7 if fluid else 6) * nen

    def make(lo, hi, dN, iJ0, wJ0, F, J, s, c, N, p, k, dt, T, G, P):
        """Factors of elements lo:hi, flat: T (element, point, 3, R), G (element, point, 3, n), P (element, point, n).

        s (., 6), c (., 6, 6), k (., 6) are those of the chunk's points, s and c of the solid alone; p (m, g). Rows of
        T: blocks xx xy xz yy yz zz and, with a fluid, pp. P = -w N.
        """
        ng = dN.shape[0]
        for e in range(lo, hi):
            for g in range(ng):
                q = (e - lo) * ng + g
                m00, m01, m02, m10, m11, m12, m20, m21, m22 = inverse_map(F[e, g], J[e, g], iJ0[e, g])
                w = wJ0[e, g] * J[e, g]
                D, S = c[q], s[q]
                pr = pw = k0 = k1 = k2 = k3 = k4 = k5 = 0.0
                if fluid:
                    pr = p[e, g]
                    pw, v = pr * w, -w * dt
                    k0, k1, k2 = k[q, 0] * v, k[q, 1] * v, k[q, 2] * v
                    k3, k4, k5 = k[q, 3] * v, k[q, 4] * v, k[q, 5] * v
                # the mixture: stress s - p I, tangent c + p (2 I4 - I x I)
                s00, s11, s22 = (S[0] - pr) * w, (S[1] - pr) * w, (S[2] - pr) * w
                s01, s12, s02 = S[3] * w, S[4] * w, S[5] * w
                d00, d11, d22 = D[0, 0] * w + pw, D[1, 1] * w + pw, D[2, 2] * w + pw
                d33, d44, d55 = D[3, 3] * w + pw, D[4, 4] * w + pw, D[5, 5] * w + pw
                d01, d02, d12 = D[0, 1] * w - pw, D[0, 2] * w - pw, D[1, 2] * w - pw
                d03, d04, d05 = D[0, 3] * w, D[0, 4] * w, D[0, 5] * w
                d13, d14, d15 = D[1, 3] * w, D[1, 4] * w, D[1, 5] * w
                d23, d24, d25 = D[2, 3] * w, D[2, 4] * w, D[2, 5] * w
                d34, d35, d45 = D[3, 4] * w, D[3, 5] * w, D[4, 5] * w
                Tq, Gq = T[3 * q * R : 3 * (q + 1) * R], G[3 * q * nen : 3 * (q + 1) * nen]
                for a in range(nen):
                    r, t, u = dN[g, a, 0], dN[g, a, 1], dN[g, a, 2]
                    x = r * m00 + t * m10 + u * m20
                    y = r * m01 + t * m11 + u * m21
                    z = r * m02 + t * m12 + u * m22
                    Gq[a] = x
                    Gq[nen + a] = y
                    Gq[2 * nen + a] = z
                    Tq[a] = (d00 + s00) * x + (d03 + s01) * y + (d05 + s02) * z
                    Tq[R + a] = (d03 + s01) * x + (d33 + s11) * y + (d35 + s12) * z
                    Tq[2 * R + a] = (d05 + s02) * x + (d35 + s12) * y + (d55 + s22) * z
                    Tq[nen + a] = d03 * x + d33 * y + d35 * z
                    Tq[R + nen + a] = d01 * x + d13 * y + d15 * z
                    Tq[2 * R + nen + a] = d04 * x + d34 * y + d45 * z
                    Tq[2 * nen + a] = d05 * x + d35 * y + d55 * z
                    Tq[R + 2 * nen + a] = d04 * x + d34 * y + d45 * z
                    Tq[2 * R + 2 * nen + a] = d02 * x + d23 * y + d25 * z
                    Tq[3 * nen + a] = (d33 + s00) * x + (d13 + s01) * y + (d34 + s02) * z
                    Tq[R + 3 * nen + a] = (d13 + s01) * x + (d11 + s11) * y + (d14 + s12) * z
                    Tq[2 * R + 3 * nen + a] = (d34 + s02) * x + (d14 + s12) * y + (d44 + s22) * z
                    Tq[4 * nen + a] = d35 * x + d15 * y + d45 * z
                    Tq[R + 4 * nen + a] = d34 * x + d14 * y + d44 * z
                    Tq[2 * R + 4 * nen + a] = d23 * x + d12 * y + d24 * z
                    Tq[5 * nen + a] = (d55 + s00) * x + (d45 + s01) * y + (d25 + s02) * z
                    Tq[R + 5 * nen + a] = (d45 + s01) * x + (d44 + s11) * y + (d24 + s12) * z
                    Tq[2 * R + 5 * nen + a] = (d25 + s02) * x + (d24 + s12) * y + (d22 + s22) * z
                    if fluid:
                        Tq[6 * nen + a] = k0 * x + k3 * y + k5 * z
                        Tq[R + 6 * nen + a] = k3 * x + k1 * y + k4 * z
                        Tq[2 * R + 6 * nen + a] = k5 * x + k4 * y + k2 * z
                        P[q * nen + a] = -w * N[g, a]

    # one name, and so one cached machine code, for each element and physics
    make.__name__ = make.__qualname__ = f"factors_{nen}_{'biphasic' if fluid else 'solid'}"
    return kernel(make, fastmath={"contract"})


def __getattr__(name: str) -> Any:
    """The kernel ``factors_8_biphasic`` under its name, by which the list of shipped machine code knows it."""
    found = re.fullmatch(r"factors_(\d+)_(solid|biphasic)", name)
    if not found:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return factors(int(found[1]), found[2] == "biphasic")


# block of components (i, j), i <= j, among the rows of the product; 6 is that of the pressure
BLOCK = np.array([[0, 1, 2, -1], [1, 3, 4, -1], [2, 4, 5, -1], [-1, -1, -1, 6]])


@kernel
def expand(n, B, U, steady, K):
    """Full component-major matrices K (n, c nen, c nen) from blocks B (n, ., nen) and couplings U (n, 3 nen, nen).

    Block 6 of B, where U is not empty, is that of the pressure. ``steady`` leaves the p-u blocks zero.
    """
    nen = B.shape[2]
    for e in range(n):
        for i in range(3):
            for j in range(i, 3):
                q = BLOCK[i, j] * nen
                for a in range(nen):
                    for b in range(nen):
                        v = B[e, q + a, b]
                        K[e, i * nen + a, j * nen + b] = v
                        K[e, j * nen + b, i * nen + a] = v
        if U.shape[0] > 0:
            m = 3 * nen
            for i in range(m):
                for b in range(nen):
                    v = U[e, i, b]
                    K[e, i, m + b] = v
                    K[e, m + b, i] = 0.0 if steady else v
            for a in range(nen):
                for b in range(nen):
                    K[e, m + a, m + b] = B[e, 6 * nen + a, b]
