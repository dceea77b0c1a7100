"""What internal forces of elements change by where nodal values change a little: for many such changes in one pass.

Of solids, with H = grad du, e its symmetric part, tangent c and stress s, and of mixtures with a fluid pressure p and
permeability K, whose rate is K' (:mod:`..permeabilities.base`, D : e = K tr e + K' - H K - K H^T):

    d(J s . grad N) = J [c : e + H s] . grad N,  s - p I and c + p (2 I4 - I x I) being those of the mixture,
    d(J w . grad N) = -J [(D : e) grad p + K grad dp] . grad N.

To these come the changes ds, dK of the laws themselves, at fixed nodal values, and dJ of the volume before the step.
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
def forces(nen: int, ng: int, fluid: bool) -> Callable[..., Any]:
    """The kernel for elements of ``nen`` nodes and ``ng`` points (fixed, so that its loops vectorise)."""
    kinds, R = (4 if fluid else 3), 3 * ng

    def make(lo, hi, conn, dN, N, iJ0, wJ0, F, J, s, c, p, gp, k, dk, dt, steady, D, which, ds, dK, dJ, out):
        """Subtract from ``out`` (v, node, 3|4) what the changes D (v, node, 3|4) do in elements lo:hi.

        s (., 6), c (., 6, 6), k (., 6), dk (., 6, 6) are those of the chunk's points, s and c of the solid alone; p
        and its gradient gp (m, g[, 3]); without dk, K = k I is constant. Change v has ds and dK (., ., 6) of number
        which[v], none where it is negative; dJ (v, m, g).
        """
        B, H = np.empty(nen * R), np.empty(nen * ng)  # natural gradients and N of a node at all points, in a row
        for g in range(ng):
            for a in range(nen):
                for i in range(3):
                    B[a * R + i * ng + g] = dN[g, a, i]
                H[a * ng + g] = N[g, a]
        # one array for all: loops as short as these are vectorised only where nothing need be checked
        Q = np.empty(89 * ng)
        A, O = 63 * ng, 76 * ng
        U = np.empty(kinds * nen)
        for e in range(lo, hi):
            for g in range(ng):  # all that changes do not matter to, point by point in columns
                q = (e - lo) * ng + g
                m00, m01, m02, m10, m11, m12, m20, m21, m22 = inverse_map(F[e, g], J[e, g], iJ0[e, g])
                w = wJ0[e, g] * J[e, g]
                S, E = s[q], c[q]
                pr = pw = 0.0
                if fluid:
                    pr = p[e, g]
                    pw = pr * w
                Q[g], Q[ng + g], Q[2 * ng + g] = m00, m01, m02
                Q[3 * ng + g], Q[4 * ng + g], Q[5 * ng + g] = m10, m11, m12
                Q[6 * ng + g], Q[7 * ng + g], Q[8 * ng + g] = m20, m21, m22
                Q[9 * ng + g], Q[10 * ng + g], Q[11 * ng + g] = (S[0] - pr) * w, (S[1] - pr) * w, (S[2] - pr) * w
                Q[12 * ng + g], Q[13 * ng + g], Q[14 * ng + g] = S[3] * w, S[4] * w, S[5] * w
                Q[15 * ng + g], Q[16 * ng + g], Q[17 * ng + g] = E[0, 0] * w + pw, E[1, 1] * w + pw, E[2, 2] * w + pw
                Q[18 * ng + g], Q[19 * ng + g], Q[20 * ng + g] = E[3, 3] * w + pw, E[4, 4] * w + pw, E[5, 5] * w + pw
                Q[21 * ng + g], Q[22 * ng + g], Q[23 * ng + g] = E[0, 1] * w - pw, E[0, 2] * w - pw, E[1, 2] * w - pw
                Q[24 * ng + g], Q[25 * ng + g], Q[26 * ng + g] = E[0, 3] * w, E[0, 4] * w, E[0, 5] * w
                Q[27 * ng + g], Q[28 * ng + g], Q[29 * ng + g] = E[1, 3] * w, E[1, 4] * w, E[1, 5] * w
                Q[30 * ng + g], Q[31 * ng + g], Q[32 * ng + g] = E[2, 3] * w, E[2, 4] * w, E[2, 5] * w
                Q[33 * ng + g], Q[34 * ng + g], Q[35 * ng + g] = E[3, 4] * w, E[3, 5] * w, E[4, 5] * w
                Q[36 * ng + g] = w
                if fluid:
                    v = -dt * w
                    x, y, z = gp[e, g, 0] * v, gp[e, g, 1] * v, gp[e, g, 2] * v
                    for r in range(6):
                        Q[(55 + r) * ng + g] = k[q, r] * v
                    if dk.shape[0] > 0:
                        for r in range(6):
                            Q[(37 + r) * ng + g] = dk[q, 0, r] * x + dk[q, 3, r] * y + dk[q, 5, r] * z
                            Q[(43 + r) * ng + g] = dk[q, 3, r] * x + dk[q, 1, r] * y + dk[q, 4, r] * z
                            Q[(49 + r) * ng + g] = dk[q, 5, r] * x + dk[q, 4, r] * y + dk[q, 2, r] * z
                    else:
                        kk = k[q, 0]
                        x, y, z = kk * x, kk * y, kk * z
                        Q[37 * ng + g], Q[38 * ng + g], Q[39 * ng + g] = -x, x, x
                        Q[40 * ng + g], Q[41 * ng + g], Q[42 * ng + g] = -y, 0.0, -z
                        Q[43 * ng + g], Q[44 * ng + g], Q[45 * ng + g] = y, -y, y
                        Q[46 * ng + g], Q[47 * ng + g], Q[48 * ng + g] = -x, -z, 0.0
                        Q[49 * ng + g], Q[50 * ng + g], Q[51 * ng + g] = z, z, -z
                        Q[52 * ng + g], Q[53 * ng + g], Q[54 * ng + g] = 0.0, -y, -x
                    Q[61 * ng + g], Q[62 * ng + g] = wJ0[e, g], (0.0 if steady else w)
            for v in range(D.shape[0]):
                for a in range(nen):
                    n = conn[e, a]
                    for i in range(kinds):
                        U[i * nen + a] = D[v, n, i]
                for r in range(R):
                    x = y = z = f = 0.0
                    for a in range(nen):
                        b = B[a * R + r]
                        x += U[a] * b
                        y += U[nen + a] * b
                        z += U[2 * nen + a] * b
                        if fluid:
                            f += U[3 * nen + a] * b
                    Q[A + r], Q[A + R + r], Q[A + 2 * R + r] = x, y, z
                    if fluid:
                        Q[A + 3 * R + r] = f
                if fluid:
                    for g in range(ng):
                        f = 0.0
                        for a in range(nen):
                            f += U[3 * nen + a] * H[a * ng + g]
                        Q[A + 4 * R + g] = f
                for g in range(ng):
                    m00, m01, m02 = Q[g], Q[ng + g], Q[2 * ng + g]
                    m10, m11, m12 = Q[3 * ng + g], Q[4 * ng + g], Q[5 * ng + g]
                    m20, m21, m22 = Q[6 * ng + g], Q[7 * ng + g], Q[8 * ng + g]
                    x, y, z = Q[A + g], Q[A + ng + g], Q[A + 2 * ng + g]
                    h00, h01 = x * m00 + y * m10 + z * m20, x * m01 + y * m11 + z * m21
                    h02 = x * m02 + y * m12 + z * m22
                    x, y, z = Q[A + R + g], Q[A + R + ng + g], Q[A + R + 2 * ng + g]
                    h10, h11 = x * m00 + y * m10 + z * m20, x * m01 + y * m11 + z * m21
                    h12 = x * m02 + y * m12 + z * m22
                    x, y, z = Q[A + 2 * R + g], Q[A + 2 * R + ng + g], Q[A + 2 * R + 2 * ng + g]
                    h20, h21 = x * m00 + y * m10 + z * m20, x * m01 + y * m11 + z * m21
                    h22 = x * m02 + y * m12 + z * m22
                    e3, e4, e5 = h01 + h10, h12 + h21, h02 + h20
                    S0, S1, S2 = Q[9 * ng + g], Q[10 * ng + g], Q[11 * ng + g]
                    S3, S4, S5 = Q[12 * ng + g], Q[13 * ng + g], Q[14 * ng + g]
                    d01, d02, d12 = Q[21 * ng + g], Q[22 * ng + g], Q[23 * ng + g]
                    d03, d04, d05 = Q[24 * ng + g], Q[25 * ng + g], Q[26 * ng + g]
                    d13, d14, d15 = Q[27 * ng + g], Q[28 * ng + g], Q[29 * ng + g]
                    d23, d24, d25 = Q[30 * ng + g], Q[31 * ng + g], Q[32 * ng + g]
                    d34, d35, d45 = Q[33 * ng + g], Q[34 * ng + g], Q[35 * ng + g]
                    t0 = Q[15 * ng + g] * h00 + d01 * h11 + d02 * h22 + d03 * e3 + d04 * e4 + d05 * e5
                    t1 = d01 * h00 + Q[16 * ng + g] * h11 + d12 * h22 + d13 * e3 + d14 * e4 + d15 * e5
                    t2 = d02 * h00 + d12 * h11 + Q[17 * ng + g] * h22 + d23 * e3 + d24 * e4 + d25 * e5
                    t3 = d03 * h00 + d13 * h11 + d23 * h22 + Q[18 * ng + g] * e3 + d34 * e4 + d35 * e5
                    t4 = d04 * h00 + d14 * h11 + d24 * h22 + d34 * e3 + Q[19 * ng + g] * e4 + d45 * e5
                    t5 = d05 * h00 + d15 * h11 + d25 * h22 + d35 * e3 + d45 * e4 + Q[20 * ng + g] * e5
                    if fluid:
                        y = Q[A + 4 * R + g] * Q[36 * ng + g]
                        t0, t1, t2 = t0 - y, t1 - y, t2 - y
                    x = t0 + h00 * S0 + h01 * S3 + h02 * S5
                    y = t3 + h00 * S3 + h01 * S1 + h02 * S4
                    z = t5 + h00 * S5 + h01 * S4 + h02 * S2
                    Q[O + g], Q[O + ng + g] = x * m00 + y * m01 + z * m02, x * m10 + y * m11 + z * m12
                    Q[O + 2 * ng + g] = x * m20 + y * m21 + z * m22
                    x = t3 + h10 * S0 + h11 * S3 + h12 * S5
                    y = t1 + h10 * S3 + h11 * S1 + h12 * S4
                    z = t4 + h10 * S5 + h11 * S4 + h12 * S2
                    Q[O + R + g], Q[O + R + ng + g] = x * m00 + y * m01 + z * m02, x * m10 + y * m11 + z * m12
                    Q[O + R + 2 * ng + g] = x * m20 + y * m21 + z * m22
                    x = t5 + h20 * S0 + h21 * S3 + h22 * S5
                    y = t4 + h20 * S3 + h21 * S1 + h22 * S4
                    z = t2 + h20 * S5 + h21 * S4 + h22 * S2
                    Q[O + 2 * R + g], Q[O + 2 * R + ng + g] = x * m00 + y * m01 + z * m02, x * m10 + y * m11 + z * m12
                    Q[O + 2 * R + 2 * ng + g] = x * m20 + y * m21 + z * m22
                    if fluid:
                        x, y, z = Q[A + 3 * R + g], Q[A + 3 * R + ng + g], Q[A + 3 * R + 2 * ng + g]
                        x, y, z = (
                            x * m00 + y * m10 + z * m20, x * m01 + y * m11 + z * m21, x * m02 + y * m12 + z * m22,
                        )  # fmt: skip
                        k3, k4, k5 = Q[58 * ng + g], Q[59 * ng + g], Q[60 * ng + g]
                        w0 = Q[55 * ng + g] * x + k3 * y + k5 * z
                        w1 = k3 * x + Q[56 * ng + g] * y + k4 * z
                        w2 = k5 * x + k4 * y + Q[57 * ng + g] * z
                        w0 += Q[37 * ng + g] * h00 + Q[38 * ng + g] * h11 + Q[39 * ng + g] * h22
                        w0 += Q[40 * ng + g] * e3 + Q[41 * ng + g] * e4 + Q[42 * ng + g] * e5
                        w1 += Q[43 * ng + g] * h00 + Q[44 * ng + g] * h11 + Q[45 * ng + g] * h22
                        w1 += Q[46 * ng + g] * e3 + Q[47 * ng + g] * e4 + Q[48 * ng + g] * e5
                        w2 += Q[49 * ng + g] * h00 + Q[50 * ng + g] * h11 + Q[51 * ng + g] * h22
                        w2 += Q[52 * ng + g] * e3 + Q[53 * ng + g] * e4 + Q[54 * ng + g] * e5
                        Q[O + 3 * R + g] = w0 * m00 + w1 * m01 + w2 * m02
                        Q[O + 3 * R + ng + g] = w0 * m10 + w1 * m11 + w2 * m12
                        Q[O + 3 * R + 2 * ng + g] = w0 * m20 + w1 * m21 + w2 * m22
                        Q[O + 4 * R + g] = -Q[62 * ng + g] * (h00 + h11 + h22)
                if fluid and not steady:
                    for g in range(ng):
                        Q[O + 4 * R + g] += Q[61 * ng + g] * dJ[v, e, g]
                if which[v] >= 0:
                    for g in range(ng):
                        q = (e - lo) * ng + g
                        d, w = ds[which[v], q], Q[36 * ng + g]
                        s0, s1, s2, s3, s4, s5 = d[0] * w, d[1] * w, d[2] * w, d[3] * w, d[4] * w, d[5] * w
                        f0 = f1 = f2 = 0.0
                        if fluid:
                            d = dK[which[v], q]
                            x, y, z = -dt * w * gp[e, g, 0], -dt * w * gp[e, g, 1], -dt * w * gp[e, g, 2]
                            f0 = d[0] * x + d[3] * y + d[5] * z
                            f1 = d[3] * x + d[1] * y + d[4] * z
                            f2 = d[5] * x + d[4] * y + d[2] * z
                        for i in range(3):
                            x, y, z = Q[3 * i * ng + g], Q[(3 * i + 1) * ng + g], Q[(3 * i + 2) * ng + g]
                            Q[O + i * ng + g] += s0 * x + s3 * y + s5 * z
                            Q[O + R + i * ng + g] += s3 * x + s1 * y + s4 * z
                            Q[O + 2 * R + i * ng + g] += s5 * x + s4 * y + s2 * z
                            if fluid:
                                Q[O + 3 * R + i * ng + g] += f0 * x + f1 * y + f2 * z
                for a in range(nen):
                    f0 = f1 = f2 = f3 = 0.0
                    for r in range(R):
                        b = B[a * R + r]
                        f0 += Q[O + r] * b
                        f1 += Q[O + R + r] * b
                        f2 += Q[O + 2 * R + r] * b
                        if fluid:
                            f3 += Q[O + 3 * R + r] * b
                    if fluid:
                        for g in range(ng):
                            f3 += Q[O + 4 * R + g] * H[a * ng + g]
                    n = conn[e, a]
                    out[v, n, 0] -= f0
                    out[v, n, 1] -= f1
                    out[v, n, 2] -= f2
                    if fluid:
                        out[v, n, 3] -= f3

    # one name, and so one cached machine code, for each element and physics
    make.__name__ = make.__qualname__ = f"forces_{nen}_{ng}_{'biphasic' if fluid else 'solid'}"
    return kernel(make, fastmath={"contract", "reassoc", "nsz"})


@lru_cache(maxsize=None)
def volumes(nen: int, ng: int) -> Callable[..., Any]:
    """The kernel for elements of ``nen`` nodes and ``ng`` points."""
    R = 3 * ng

    def make(lo, hi, conn, dN, iJ0, F, J, D, dJ):
        """dJ (v, m, g) = J tr H of elements lo:hi, for changes D (v, node, 3|4)."""
        B, Q = np.empty(nen * R), np.empty(19 * ng)
        A, O = 9 * ng, 18 * ng
        U = np.empty(3 * nen)
        for g in range(ng):
            for a in range(nen):
                for i in range(3):
                    B[a * R + i * ng + g] = dN[g, a, i]
        for e in range(lo, hi):
            for g in range(ng):
                m00, m01, m02, m10, m11, m12, m20, m21, m22 = inverse_map(F[e, g], J[e, g], iJ0[e, g])
                j = J[e, g]
                Q[g], Q[ng + g], Q[2 * ng + g] = m00 * j, m10 * j, m20 * j
                Q[3 * ng + g], Q[4 * ng + g], Q[5 * ng + g] = m01 * j, m11 * j, m21 * j
                Q[6 * ng + g], Q[7 * ng + g], Q[8 * ng + g] = m02 * j, m12 * j, m22 * j
            for v in range(D.shape[0]):
                for a in range(nen):
                    n = conn[e, a]
                    U[a], U[nen + a], U[2 * nen + a] = D[v, n, 0], D[v, n, 1], D[v, n, 2]
                for r in range(R):
                    x = y = z = 0.0
                    for a in range(nen):
                        b = B[a * R + r]
                        x += U[a] * b
                        y += U[nen + a] * b
                        z += U[2 * nen + a] * b
                    Q[A + r], Q[A + R + r], Q[A + 2 * R + r] = x, y, z
                for g in range(ng):
                    x = Q[A + g] * Q[g] + Q[A + ng + g] * Q[ng + g] + Q[A + 2 * ng + g] * Q[2 * ng + g]
                    y = Q[A + R + g] * Q[3 * ng + g] + Q[A + R + ng + g] * Q[4 * ng + g]
                    y += Q[A + R + 2 * ng + g] * Q[5 * ng + g]
                    z = Q[A + 2 * R + g] * Q[6 * ng + g] + Q[A + 2 * R + ng + g] * Q[7 * ng + g]
                    z += Q[A + 2 * R + 2 * ng + g] * Q[8 * ng + g]
                    Q[O + g] = x + y + z
                for g in range(ng):
                    dJ[v, e, g] = Q[O + g]

    make.__name__ = make.__qualname__ = f"volumes_{nen}_{ng}"
    return kernel(make, fastmath={"contract", "reassoc", "nsz"})


def __getattr__(name: str) -> Any:
    """The kernels ``forces_8_8_biphasic`` and ``volumes_8_8`` under their names, by which the list of shipped machine
    code knows them."""
    found = re.fullmatch(r"(forces|volumes)_(\d+)_(\d+)(?:_(solid|biphasic))?", name)
    if not found:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    nen, ng = int(found[2]), int(found[3])
    return volumes(nen, ng) if found[1] == "volumes" else forces(nen, ng, found[4] == "biphasic")
