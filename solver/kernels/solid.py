"""Element integrals of the solid: deformation gradient, internal force, tangent.

Element matrices are component-major: row ``i * n + a`` is component i of local node a (n nodes), so
that the innermost loops run over contiguous local nodes. Kernels work on the elements ``lo:hi`` of a
block; chunk arrays start at 0 for element ``lo``.
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel


@kernel
def reference(X, conn, dN, w, iJ0, wJ0):
    """Inverse reference Jacobians (m, g, 3, 3) and weighted determinants (m, g).

    iJ0[k, i] = d xi_k / d X_i. Returns the number of elements with a non-positive Jacobian.
    """
    bad = 0
    for e in range(conn.shape[0]):
        ok = True
        for g in range(dN.shape[0]):
            a00 = a01 = a02 = a10 = a11 = a12 = a20 = a21 = a22 = 0.0
            for a in range(conn.shape[1]):
                n = conn[e, a]
                x, y, z = X[n, 0], X[n, 1], X[n, 2]
                r, s, t = dN[g, a, 0], dN[g, a, 1], dN[g, a, 2]
                a00 += x * r
                a01 += x * s
                a02 += x * t
                a10 += y * r
                a11 += y * s
                a12 += y * t
                a20 += z * r
                a21 += z * s
                a22 += z * t
            det = a00 * (a11 * a22 - a12 * a21) - a01 * (a10 * a22 - a12 * a20) + a02 * (a10 * a21 - a11 * a20)
            if det <= 0.0:
                ok = False
            d = 1.0 / det if det != 0.0 else 0.0
            iJ0[e, g, 0, 0] = (a11 * a22 - a12 * a21) * d
            iJ0[e, g, 0, 1] = (a02 * a21 - a01 * a22) * d
            iJ0[e, g, 0, 2] = (a01 * a12 - a02 * a11) * d
            iJ0[e, g, 1, 0] = (a12 * a20 - a10 * a22) * d
            iJ0[e, g, 1, 1] = (a00 * a22 - a02 * a20) * d
            iJ0[e, g, 1, 2] = (a02 * a10 - a00 * a12) * d
            iJ0[e, g, 2, 0] = (a10 * a21 - a11 * a20) * d
            iJ0[e, g, 2, 1] = (a01 * a20 - a00 * a21) * d
            iJ0[e, g, 2, 2] = (a00 * a11 - a01 * a10) * d
            wJ0[e, g] = w[g] * det
        if not ok:
            bad += 1
    return bad


@kernel
def kinematics(lo, hi, u, conn, dN, iJ0, F, J):
    """Deformation gradient F = I + du/dX (m, g, 3, 3) and J (m, g) of elements lo:hi, for displacements u (node, 3).

    Displacements rather than positions, whose rounding would grow with the distance from the origin.
    Returns the first element with J <= 0, or -1.
    """
    bad = -1
    ng, nen = dN.shape[0], conn.shape[1]
    D, A = np.empty((nen, 3 * ng)), np.empty((3, 3 * ng))  # natural gradients of all points side by side
    for g in range(ng):
        for a in range(nen):
            for k in range(3):
                D[a, 3 * g + k] = dN[g, a, k]
    for e in range(lo, hi):
        A[:] = 0.0
        for a in range(nen):
            n = conn[e, a]
            p, v, q = u[n, 0], u[n, 1], u[n, 2]
            for r in range(3 * ng):
                d = D[a, r]
                A[0, r] += p * d
                A[1, r] += v * d
                A[2, r] += q * d
        for g in range(ng):
            r = 3 * g
            for j in range(3):
                k0, k1, k2 = iJ0[e, g, 0, j], iJ0[e, g, 1, j], iJ0[e, g, 2, j]
                F[e, g, 0, j] = A[0, r] * k0 + A[0, r + 1] * k1 + A[0, r + 2] * k2
                F[e, g, 1, j] = A[1, r] * k0 + A[1, r + 1] * k1 + A[1, r + 2] * k2
                F[e, g, 2, j] = A[2, r] * k0 + A[2, r + 1] * k1 + A[2, r + 2] * k2
                F[e, g, j, j] += 1.0
            f = F[e, g]
            det = (
                f[0, 0] * (f[1, 1] * f[2, 2] - f[1, 2] * f[2, 1])
                - f[0, 1] * (f[1, 0] * f[2, 2] - f[1, 2] * f[2, 0])
                + f[0, 2] * (f[1, 0] * f[2, 1] - f[1, 1] * f[2, 0])
            )
            J[e, g] = det
            if not det > 0.0 and bad < 0:
                bad = e
    return bad


@kernel
def inverse_map(F, J, iJ0):
    """The derivatives of natural by spatial coordinates at one point, iJ0 F^-1, row by row."""
    d = 1.0 / J
    i00 = (F[1, 1] * F[2, 2] - F[1, 2] * F[2, 1]) * d
    i01 = (F[0, 2] * F[2, 1] - F[0, 1] * F[2, 2]) * d
    i02 = (F[0, 1] * F[1, 2] - F[0, 2] * F[1, 1]) * d
    i10 = (F[1, 2] * F[2, 0] - F[1, 0] * F[2, 2]) * d
    i11 = (F[0, 0] * F[2, 2] - F[0, 2] * F[2, 0]) * d
    i12 = (F[0, 2] * F[1, 0] - F[0, 0] * F[1, 2]) * d
    i20 = (F[1, 0] * F[2, 1] - F[1, 1] * F[2, 0]) * d
    i21 = (F[0, 1] * F[2, 0] - F[0, 0] * F[2, 1]) * d
    i22 = (F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]) * d
    return (
        iJ0[0, 0] * i00 + iJ0[0, 1] * i10 + iJ0[0, 2] * i20,
        iJ0[0, 0] * i01 + iJ0[0, 1] * i11 + iJ0[0, 2] * i21,
        iJ0[0, 0] * i02 + iJ0[0, 1] * i12 + iJ0[0, 2] * i22,
        iJ0[1, 0] * i00 + iJ0[1, 1] * i10 + iJ0[1, 2] * i20,
        iJ0[1, 0] * i01 + iJ0[1, 1] * i11 + iJ0[1, 2] * i21,
        iJ0[1, 0] * i02 + iJ0[1, 1] * i12 + iJ0[1, 2] * i22,
        iJ0[2, 0] * i00 + iJ0[2, 1] * i10 + iJ0[2, 2] * i20,
        iJ0[2, 0] * i01 + iJ0[2, 1] * i11 + iJ0[2, 2] * i21,
        iJ0[2, 0] * i02 + iJ0[2, 1] * i12 + iJ0[2, 2] * i22,
    )


@kernel
def gradients(F, J, iJ0, dN, G):
    """Spatial shape gradients at one point: G (3, n) from F (3, 3), det J, iJ0 (3, 3), dN (n, 3)."""
    m00, m01, m02, m10, m11, m12, m20, m21, m22 = inverse_map(F, J, iJ0)
    for a in range(dN.shape[0]):
        r, s, t = dN[a, 0], dN[a, 1], dN[a, 2]
        G[0, a] = r * m00 + s * m10 + t * m20
        G[1, a] = r * m01 + s * m11 + t * m21
        G[2, a] = r * m02 + s * m12 + t * m22


@kernel
def internal_force(lo, hi, conn, dN, iJ0, wJ0, F, J, s, R):
    """Subtract the internal force of elements lo:hi, sum_g s . grad N w j, from R (node, 3).

    s is pulled to natural coordinates at each point, so that no gradients are formed.
    """
    nen = conn.shape[1]
    f = np.empty((3, nen))
    for e in range(lo, hi):
        f[:] = 0.0
        for g in range(dN.shape[0]):
            m00, m01, m02, m10, m11, m12, m20, m21, m22 = inverse_map(F[e, g], J[e, g], iJ0[e, g])
            w = wJ0[e, g] * J[e, g]
            s0, s1, s2 = s[e, g, 0] * w, s[e, g, 1] * w, s[e, g, 2] * w
            s3, s4, s5 = s[e, g, 3] * w, s[e, g, 4] * w, s[e, g, 5] * w
            a00, a01 = s0 * m00 + s3 * m01 + s5 * m02, s0 * m10 + s3 * m11 + s5 * m12
            a10, a11 = s3 * m00 + s1 * m01 + s4 * m02, s3 * m10 + s1 * m11 + s4 * m12
            a20, a21 = s5 * m00 + s4 * m01 + s2 * m02, s5 * m10 + s4 * m11 + s2 * m12
            a02 = s0 * m20 + s3 * m21 + s5 * m22
            a12 = s3 * m20 + s1 * m21 + s4 * m22
            a22 = s5 * m20 + s4 * m21 + s2 * m22
            for a in range(nen):
                x, y, z = dN[g, a, 0], dN[g, a, 1], dN[g, a, 2]
                f[0, a] += a00 * x + a01 * y + a02 * z
                f[1, a] += a10 * x + a11 * y + a12 * z
                f[2, a] += a20 * x + a21 * y + a22 * z
        for a in range(nen):
            n = conn[e, a]
            R[n, 0] -= f[0, a]
            R[n, 1] -= f[1, a]
            R[n, 2] -= f[2, a]


@kernel
def add_point_stiffness(nen, D, s, w, G, DB, T, K):
    """Add w (B^T D B + geometric) of one point to K[:3n, :3n] (component-major).

    D (6, 6) spatial tangent, s (6) Cauchy stress, G (3, n) spatial gradients; DB, T are scratch
    (6, 3 n) and (n).
    """
    for r in range(6):
        d0, d1, d2, d3, d4, d5 = D[r, 0] * w, D[r, 1] * w, D[r, 2] * w, D[r, 3] * w, D[r, 4] * w, D[r, 5] * w
        for b in range(nen):
            x, y, z = G[0, b], G[1, b], G[2, b]
            DB[r, b] = d0 * x + d3 * y + d5 * z
            DB[r, nen + b] = d1 * y + d3 * x + d4 * z
            DB[r, 2 * nen + b] = d2 * z + d4 * y + d5 * x
    s0, s1, s2, s3, s4, s5 = s[0] * w, s[1] * w, s[2] * w, s[3] * w, s[4] * w, s[5] * w
    m = 3 * nen
    for a in range(nen):
        x, y, z = G[0, a], G[1, a], G[2, a]
        t0, t1, t2 = s0 * x + s3 * y + s5 * z, s3 * x + s1 * y + s4 * z, s5 * x + s4 * y + s2 * z
        Kx, Ky, Kz = K[a], K[nen + a], K[2 * nen + a]
        D0, D1, D2, D3, D4, D5 = DB[0], DB[1], DB[2], DB[3], DB[4], DB[5]
        for b in range(m):
            Kx[b] += x * D0[b] + y * D3[b] + z * D5[b]
            Ky[b] += y * D1[b] + x * D3[b] + z * D4[b]
            Kz[b] += z * D2[b] + y * D4[b] + x * D5[b]
        for b in range(nen):
            T[b] = t0 * G[0, b] + t1 * G[1, b] + t2 * G[2, b]
        for b in range(nen):
            Kx[b] += T[b]
            Ky[nen + b] += T[b]
            Kz[2 * nen + b] += T[b]


@kernel
def stiffness(lo, hi, dN, iJ0, wJ0, F, J, s, c, K):
    """Tangent of elements lo:hi into K (hi - lo, 3n, 3n); s, c are chunk arrays (hi - lo, g, ...)."""
    nen = dN.shape[1]
    G = np.empty((3, nen))
    DB = np.empty((6, 3 * nen))
    T = np.empty(nen)
    for e in range(lo, hi):
        k = K[e - lo]
        k[:] = 0.0
        for g in range(dN.shape[0]):
            gradients(F[e, g], J[e, g], iJ0[e, g], dN[g], G)
            add_point_stiffness(nen, c[e - lo, g], s[e - lo, g], wJ0[e, g] * J[e, g], G, DB, T, k)
