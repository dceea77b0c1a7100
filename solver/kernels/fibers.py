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
def power_tension(In, ksi, beta, sn, cn):
    """sn = 2 In dW/dIn and cn = 4 In^2 d2W/dIn2 (n, m) of W = ksi (In - 1)^beta in tension; ksi, beta (1|n, m)."""
    for i in range(In.shape[0]):
        a = i if ksi.shape[0] > 1 else 0
        b = i if beta.shape[0] > 1 else 0
        for j in range(In.shape[1]):
            x = In[i, j] - 1.0
            sn[i, j] = cn[i, j] = 0.0
            if x > 0.0:
                q = beta[b, j]
                # powers are dear, and exponents of a spherical family 2 or 3 but for rounding
                if abs(q - 3.0) < 1e-14:
                    power = x
                elif abs(q - 2.0) < 1e-14:
                    power = 1.0
                else:
                    power = x ** (q - 2.0)
                k = ksi[a, j] * q * power
                sn[i, j] = 2.0 * In[i, j] * k * x
                cn[i, j] = 4.0 * In[i, j] * In[i, j] * k * (q - 1.0)


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
        if iso:
            add_deviatoric_stress(s, i, 1.0 / J[i], T)
            if c.shape[0] > 0:
                add_deviatoric_tangent(c, i, 1.0 / J[i], T, h)
        else:
            for p in range(6):
                s[i, p] += T[p] / J[i]
                if c.shape[0] > 0:
                    for q in range(6):
                        c[i, p, q] += h[0, p, q] / J[i]
