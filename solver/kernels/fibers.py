"""Sums over fibers: stretch along reference directions, and the push forward of fiber tensions.

``A`` (1|n, m, 3) unit reference directions, ``w`` (1|n, m) weights. ``iso`` = 1 uses the distortional
F~ = J^-1/3 F and adds the deviatoric part.
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from .tensors import (
    add_circles,
    add_deviatoric_stress,
    add_deviatoric_tangent,
    add_dyad,
    clear,
    dyad_of,
    left_cauchy_green,
    symmetric_product,
)


@kernel
def squared_stretch(F, J, A, iso, In):
    """In = a0 . C a0 (n, m)."""
    for i in range(In.shape[0]):
        d = i if A.shape[0] > 1 else 0
        k = J[i] ** (-2.0 / 3.0) if iso else 1.0
        for j in range(In.shape[1]):
            q = 0.0
            for p in range(3):
                x = F[i, p, 0] * A[d, j, 0] + F[i, p, 1] * A[d, j, 1] + F[i, p, 2] * A[d, j, 2]
                q += x * x
            In[i, j] = k * q


@kernel
def add_fibers(F, J, A, w, In, sn, cn, g, iso, s, c):
    """Add sum_j w_j (sn N + g sym(N' (B - I))) / J and its tangent.

    N = n dyad n with the unit spatial direction n, N' = In N; ``sn`` = 2 In dW/dIn, ``cn`` = 4 In^2 d2W/dIn2
    (n, m); ``g`` (n, m) the modulus of the shear term, or (0, 0).
    """
    T, h = np.empty(6), np.empty((1, 6, 6))
    B, BI, N, S = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    for i in range(len(J)):
        d = i if A.shape[0] > 1 else 0
        e = i if w.shape[0] > 1 else 0
        clear(T, h)
        if g.shape[0] > 0:
            left_cauchy_green(F, i, J[i] ** (-2.0 / 3.0) if iso else 1.0, B)
            for p in range(6):
                BI[p] = B[p] - 1.0 if p < 3 else B[p]
        for j in range(In.shape[1]):
            if sn[i, j] == 0.0 and cn[i, j] == 0.0 and (g.shape[0] == 0 or g[i, j] == 0.0):
                continue
            x = F[i, 0, 0] * A[d, j, 0] + F[i, 0, 1] * A[d, j, 1] + F[i, 0, 2] * A[d, j, 2]
            y = F[i, 1, 0] * A[d, j, 0] + F[i, 1, 1] * A[d, j, 1] + F[i, 1, 2] * A[d, j, 2]
            z = F[i, 2, 0] * A[d, j, 0] + F[i, 2, 1] * A[d, j, 1] + F[i, 2, 2] * A[d, j, 2]
            l = 1.0 / np.sqrt(x * x + y * y + z * z)
            dyad_of(x * l, y * l, z * l, N)
            for p in range(6):
                T[p] += w[e, j] * sn[i, j] * N[p]
            if c.shape[0] > 0:
                add_dyad(h, 0, w[e, j] * cn[i, j], N)
            if g.shape[0] > 0 and g[i, j] != 0.0:
                k = w[e, j] * g[i, j] * In[i, j]
                symmetric_product(N, BI, S)
                for p in range(6):
                    T[p] += k * S[p]
                if c.shape[0] > 0:
                    add_circles(h, 0, k, N, B)
        add_sums(s, c, i, J[i], T, h, iso)


@kernel
def add_power_fibers(F, J, A, w, Q, ksi, beta, iso, s, c):
    """Add the stress and tangent of fibers W = ksi (In - 1)^beta in tension; w (m,), ksi, beta (1|n, m).

    Where axes ``Q`` (0|1|n, 3, 3; columns) are given, ksi and beta are (1|n, 3): 1/r^2 of the ellipsoids along them.
    n dyad n dyad n dyad n has fifteen different components, summed up by pairs of coordinates.
    """
    T, h, M = np.empty(6), np.empty((1, 6, 6)), np.empty((5, 3))
    for i in range(len(J)):
        d = i if A.shape[0] > 1 else 0
        a = i if ksi.shape[0] > 1 else 0
        b = i if beta.shape[0] > 1 else 0
        local = i if Q.shape[0] > 1 else 0
        scale = J[i] ** (-2.0 / 3.0) if iso else 1.0
        clear(T, h)
        M[:] = 0.0
        for j in range(A.shape[1]):
            x = F[i, 0, 0] * A[d, j, 0] + F[i, 0, 1] * A[d, j, 1] + F[i, 0, 2] * A[d, j, 2]
            y = F[i, 1, 0] * A[d, j, 0] + F[i, 1, 1] * A[d, j, 1] + F[i, 1, 2] * A[d, j, 2]
            z = F[i, 2, 0] * A[d, j, 0] + F[i, 2, 1] * A[d, j, 1] + F[i, 2, 2] * A[d, j, 2]
            xx, yy, zz = x * x, y * y, z * z
            e = scale * (xx + yy + zz) - 1.0
            if e <= 0.0:
                continue
            if Q.shape[0] > 0:
                r = q = 0.0
                for p in range(3):
                    n = A[d, j, 0] * Q[local, 0, p] + A[d, j, 1] * Q[local, 1, p] + A[d, j, 2] * Q[local, 2, p]
                    r += n * n * ksi[a, p]
                    q += n * n * beta[b, p]
                r, q = 1.0 / np.sqrt(r), 1.0 / np.sqrt(q)
            else:
                r, q = ksi[a, j], beta[b, j]
            k = 2.0 * w[j] * r * q * scale * _power(e, q - 2.0)
            xy, yz, xz = x * y, y * z, x * z
            f = k * e
            T[0] += f * xx
            T[1] += f * yy
            T[2] += f * zz
            T[3] += f * xy
            T[4] += f * yz
            T[5] += f * xz
            if c.shape[0] > 0:
                g = 2.0 * scale * k * (q - 1.0)
                gx, gy, gz = g * xx, g * yy, g * zz
                M[0, 0] += gx * xx
                M[0, 1] += gy * yy
                M[0, 2] += gz * zz
                M[1, 0] += gx * yy
                M[1, 1] += gy * zz
                M[1, 2] += gx * zz
                M[2, 0] += gx * xy
                M[2, 1] += gy * xy
                M[2, 2] += gz * xy
                M[3, 0] += gx * yz
                M[3, 1] += gy * yz
                M[3, 2] += gz * yz
                M[4, 0] += gx * xz
                M[4, 1] += gy * xz
                M[4, 2] += gz * xz
        _fill(M, h)
        add_sums(s, c, i, J[i], T, h, iso)


@kernel
def add_sums(s, c, i, J, T, h, iso):
    """Add stress T / J and tangent h / J of point i, deviatoric ones where ``iso``."""
    if iso:
        add_deviatoric_stress(s, i, 1.0 / J, T)
        if c.shape[0] > 0:
            add_deviatoric_tangent(c, i, 1.0 / J, T, h)
        return
    for p in range(6):
        s[i, p] += T[p] / J
        if c.shape[0] > 0:
            for q in range(6):
                c[i, p, q] += h[0, p, q] / J


@kernel
def _power(x, q):
    """x^q: powers are dear, and exponents of a spherical family 0, 1/2 or 1 but for rounding."""
    if abs(q) < 1e-14:
        return 1.0
    if abs(q - 0.5) < 1e-14:
        return np.sqrt(x)
    if abs(q - 1.0) < 1e-14:
        return x
    return x**q


@kernel
def _fill(M, h):
    """h (1, 6, 6) of sums M (5, 3) of xxxx yyyy zzzz, xxyy yyzz xxzz, and xx yy zz by xy, by yz, by xz."""
    for p in range(3):
        h[0, p, p] = M[0, p]
        for q in range(3):
            h[0, p, 3 + q] = h[0, 3 + q, p] = M[2 + q, p]
    h[0, 0, 1] = h[0, 1, 0] = h[0, 3, 3] = M[1, 0]
    h[0, 1, 2] = h[0, 2, 1] = h[0, 4, 4] = M[1, 1]
    h[0, 0, 2] = h[0, 2, 0] = h[0, 5, 5] = M[1, 2]
    h[0, 3, 4] = h[0, 4, 3] = M[4, 1]
    h[0, 4, 5] = h[0, 5, 4] = M[2, 2]
    h[0, 3, 5] = h[0, 5, 3] = M[3, 0]
