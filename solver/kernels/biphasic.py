"""Element integrals of the biphasic mixture (u-p, backward Euler, FEBio theory manual, biphasic FE).

p rows: dt * [ sum (w . grad N + (phi_hat - div v) N) ] with div v = (1 - J_prev / J) / dt,
w = -K grad p. Component-major element matrices with the pressure as fourth component.
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from .solid import add_point_stiffness, gradients, inverse_map


@kernel
def pressures(lo, hi, conn, N, dN, iJ0, F, J, p, pg, gp):
    """Fluid pressure pg (m, g) and its spatial gradient gp (m, g, 3) of elements lo:hi."""
    ng, nen = dN.shape[0], conn.shape[1]
    D, A = np.empty((nen, 4 * ng)), np.empty(4 * ng)  # natural gradients and N of all points side by side
    for g in range(ng):
        for a in range(nen):
            for k in range(3):
                D[a, 4 * g + k] = dN[g, a, k]
            D[a, 4 * g + 3] = N[g, a]
    for e in range(lo, hi):
        A[:] = 0.0
        for a in range(nen):
            q = p[conn[e, a]]
            for r in range(4 * ng):
                A[r] += q * D[a, r]
        for g in range(ng):
            x, y, z = A[4 * g], A[4 * g + 1], A[4 * g + 2]
            k, f, d = iJ0[e, g], F[e, g], 1.0 / J[e, g]
            # the gradient in the reference, then F^-T of it
            x, y, z = (
                (x * k[0, 0] + y * k[1, 0] + z * k[2, 0]) * d,
                (x * k[0, 1] + y * k[1, 1] + z * k[2, 1]) * d,
                (x * k[0, 2] + y * k[1, 2] + z * k[2, 2]) * d,
            )
            pg[e, g] = A[4 * g + 3]
            gp[e, g, 0] = (
                x * (f[1, 1] * f[2, 2] - f[1, 2] * f[2, 1])
                + y * (f[1, 2] * f[2, 0] - f[1, 0] * f[2, 2])
                + z * (f[1, 0] * f[2, 1] - f[1, 1] * f[2, 0])
            )
            gp[e, g, 1] = (
                x * (f[0, 2] * f[2, 1] - f[0, 1] * f[2, 2])
                + y * (f[0, 0] * f[2, 2] - f[0, 2] * f[2, 0])
                + z * (f[0, 1] * f[2, 0] - f[0, 0] * f[2, 1])
            )
            gp[e, g, 2] = (
                x * (f[0, 1] * f[1, 2] - f[0, 2] * f[1, 1])
                + y * (f[0, 2] * f[1, 0] - f[0, 0] * f[1, 2])
                + z * (f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0])
            )


@kernel
def flux(lo, hi, k, gp, drive, w):
    """Fluid flux w = -K (grad p - drive) for chunk permeabilities k (n, 6), gp and w (m, g, 3).

    ``drive`` (n, 3) is the body force on the fluid (true density times force), or of length 0.
    """
    ng = gp.shape[1]
    for e in range(lo, hi):
        for g in range(ng):
            i = (e - lo) * ng + g
            x, y, z = gp[e, g, 0], gp[e, g, 1], gp[e, g, 2]
            if drive.shape[0] > 0:
                x -= drive[i, 0]
                y -= drive[i, 1]
                z -= drive[i, 2]
            w[e, g, 0] = -(k[i, 0] * x + k[i, 3] * y + k[i, 5] * z)
            w[e, g, 1] = -(k[i, 3] * x + k[i, 1] * y + k[i, 4] * z)
            w[e, g, 2] = -(k[i, 5] * x + k[i, 4] * y + k[i, 2] * z)


@kernel(fastmath={"contract", "reassoc", "nsz"})  # sums over points several terms at a time
def internal_force(lo, hi, conn, N, dN, iJ0, wJ0, F, J, Jp, s, p, w, supply, dt, steady, Ru, Rp):
    """Subtract the internal force of elements lo:hi from Ru (node, 3) and Rp (node,), of displacement and pressure.

    s: solid (effective) stress; p (m, g) pressure; w (m, g, 3) flux; supply (m, g) or (0, 0).
    ``steady`` drops div v (steady-state analysis).
    """
    ng, nen = dN.shape[0], conn.shape[1]
    D, H = np.empty((nen, 3 * ng)), np.empty((nen, ng))  # natural gradients and N of a node at all points, in a row
    for g in range(ng):
        for a in range(nen):
            for k in range(3):
                D[a, k * ng + g] = dN[g, a, k]
            H[a, g] = N[g, a]
    A, h = np.empty((4, 3 * ng)), np.empty(ng)
    for e in range(lo, hi):
        for g in range(ng):
            m00, m01, m02, m10, m11, m12, m20, m21, m22 = inverse_map(F[e, g], J[e, g], iJ0[e, g])
            v = wJ0[e, g] * J[e, g]
            q = p[e, g]
            s0, s1, s2 = (s[e, g, 0] - q) * v, (s[e, g, 1] - q) * v, (s[e, g, 2] - q) * v
            s3, s4, s5 = s[e, g, 3] * v, s[e, g, 4] * v, s[e, g, 5] * v
            w0, w1, w2 = w[e, g, 0] * v * dt, w[e, g, 1] * v * dt, w[e, g, 2] * v * dt
            # stress and flux in natural coordinates: no gradients are formed
            i, j, k = g, ng + g, 2 * ng + g
            A[0, i], A[0, j] = s0 * m00 + s3 * m01 + s5 * m02, s0 * m10 + s3 * m11 + s5 * m12
            A[1, i], A[1, j] = s3 * m00 + s1 * m01 + s4 * m02, s3 * m10 + s1 * m11 + s4 * m12
            A[2, i], A[2, j] = s5 * m00 + s4 * m01 + s2 * m02, s5 * m10 + s4 * m11 + s2 * m12
            A[3, i], A[3, j] = w0 * m00 + w1 * m01 + w2 * m02, w0 * m10 + w1 * m11 + w2 * m12
            A[0, k] = s0 * m20 + s3 * m21 + s5 * m22
            A[1, k] = s3 * m20 + s1 * m21 + s4 * m22
            A[2, k] = s5 * m20 + s4 * m21 + s2 * m22
            A[3, k] = w0 * m20 + w1 * m21 + w2 * m22
            # dt (phi_hat - div v) w j, with dt div v = 1 - J_prev / J
            h[g] = 0.0 if steady else -wJ0[e, g] * (J[e, g] - Jp[e, g])
            if supply.shape[0] > 0:
                h[g] += supply[e, g] * v * dt
        for a in range(nen):
            f0 = f1 = f2 = f3 = 0.0
            for r in range(3 * ng):
                d = D[a, r]
                f0 += A[0, r] * d
                f1 += A[1, r] * d
                f2 += A[2, r] * d
                f3 += A[3, r] * d
            for g in range(ng):
                f3 += h[g] * H[a, g]
            n = conn[e, a]
            Ru[n, 0] -= f0
            Ru[n, 1] -= f1
            Ru[n, 2] -= f2
            Rp[n] -= f3


@kernel
def stiffness(lo, hi, N, dN, iJ0, wJ0, F, J, s, c, p, k, dt, steady, K):
    """Tangent of elements lo:hi into K (hi - lo, 4n, 4n), symmetric part.

    s (solid stress), c and k (permeability) are chunk arrays; the total stress s - p I and its tangent
    c + p (2 I4 - I x I) are formed here (overwriting s and c). Terms of strain-dependent permeability
    and of solvent supply are added by :func:`coupling`.
    """
    nen = dN.shape[1]
    G = np.empty((3, nen))
    KG = np.empty((3, nen))
    DB = np.empty((6, 3 * nen))
    T = np.empty(nen)
    for e in range(lo, hi):
        M = K[e - lo]
        M[:] = 0.0
        for g in range(dN.shape[0]):
            gradients(F[e, g], J[e, g], iJ0[e, g], dN[g], G)
            w = wJ0[e, g] * J[e, g]
            D, S, q = c[e - lo, g], s[e - lo, g], p[e, g]
            for i in range(3):
                S[i] -= q
                D[i, i] += q
                D[3 + i, 3 + i] += q
                for j in range(3):
                    if i != j:
                        D[i, j] -= q
            add_point_stiffness(nen, D, S, w, G, DB, T, M)
            kp = k[(e - lo) * dN.shape[0] + g]
            v = w * dt
            for b in range(nen):
                x, y, z = G[0, b], G[1, b], G[2, b]
                KG[0, b] = (kp[0] * x + kp[3] * y + kp[5] * z) * v
                KG[1, b] = (kp[3] * x + kp[1] * y + kp[4] * z) * v
                KG[2, b] = (kp[5] * x + kp[4] * y + kp[2] * z) * v
            for i in range(3):
                for a in range(nen):
                    x = G[i, a] * w
                    row = M[i * nen + a]
                    for b in range(nen):
                        row[3 * nen + b] -= x * N[g, b]
            for a in range(nen):
                x, y, z = G[0, a], G[1, a], G[2, a]
                row = M[3 * nen + a]
                for b in range(nen):
                    row[3 * nen + b] -= x * KG[0, b] + y * KG[1, b] + z * KG[2, b]
                if not steady:
                    h = N[g, a] * w
                    for i in range(3):
                        for b in range(nen):
                            row[i * nen + b] -= h * G[i, b]


@kernel
def permeability_coupling(lo, hi, dN, iJ0, wJ0, F, J, gp, dk, dt, steady, K):
    """Add to the p-u blocks the tangent of a strain-dependent permeability, as FEBio 4.11 has it.

    Consistent were -dt grad N_i dk_ij,kl grad p_j (grad v)_kl; FEBio exchanges j and k, in steady states grad N and
    grad p besides. dk (n, 6, 6): FEBio's spatial strain tangent of the permeability, 2 J^-1 push-forward of dK/dC, row
    index of K, column index of strain; gp (m, g, 3).
    """
    nen = dN.shape[1]
    G = np.empty((3, nen))
    S, T = np.empty((6, 3)), np.empty((3, 3))
    for e in range(lo, hi):
        M = K[e - lo]
        for g in range(dN.shape[0]):
            gradients(F[e, g], J[e, g], iJ0[e, g], dN[g], G)
            w = wJ0[e, g] * J[e, g] * dt
            D = dk[(e - lo) * dN.shape[0] + g]
            x, y, z = gp[e, g, 0] * w, gp[e, g, 1] * w, gp[e, g, 2] * w
            for r in range(6):
                if steady:  # S[kl, j] = dk_ij,kl grad p_i
                    S[r, 0] = D[0, r] * x + D[3, r] * y + D[5, r] * z
                    S[r, 1] = D[3, r] * x + D[1, r] * y + D[4, r] * z
                    S[r, 2] = D[5, r] * x + D[4, r] * y + D[2, r] * z
                else:  # S[ij, l] = dk_ij,kl grad p_k
                    S[r, 0] = D[r, 0] * x + D[r, 3] * y + D[r, 5] * z
                    S[r, 1] = D[r, 3] * x + D[r, 1] * y + D[r, 4] * z
                    S[r, 2] = D[r, 5] * x + D[r, 4] * y + D[r, 2] * z
            for a in range(nen):
                row = M[3 * nen + a]
                g0, g1, g2 = G[0, a], G[1, a], G[2, a]
                for q in range(3):
                    t0 = g0 * S[0, q] + g1 * S[3, q] + g2 * S[5, q]
                    t1 = g0 * S[3, q] + g1 * S[1, q] + g2 * S[4, q]
                    t2 = g0 * S[5, q] + g1 * S[4, q] + g2 * S[2, q]
                    if steady:
                        T[q, 0], T[q, 1], T[q, 2] = t0, t1, t2
                    else:
                        T[0, q], T[1, q], T[2, q] = t0, t1, t2
                for b in range(nen):
                    bx, by, bz = G[0, b], G[1, b], G[2, b]
                    row[b] -= T[0, 0] * bx + T[0, 1] * by + T[0, 2] * bz
                    row[nen + b] -= T[1, 0] * bx + T[1, 1] * by + T[1, 2] * bz
                    row[2 * nen + b] -= T[2, 0] * bx + T[2, 1] * by + T[2, 2] * bz


@kernel
def supply_coupling(lo, hi, N, dN, iJ0, wJ0, F, J, supply, dE, dp, dt, K):
    """Add the tangent of a solvent supply phi_hat: rows p, dt N (phi_hat I + J dphi/dE) grad v and dt N N dphi/dp.

    supply (n,), dE (n, 6), dp (n,) over the chunk's points.
    """
    nen = dN.shape[1]
    G = np.empty((3, nen))
    for e in range(lo, hi):
        M = K[e - lo]
        for g in range(dN.shape[0]):
            i = (e - lo) * dN.shape[0] + g
            gradients(F[e, g], J[e, g], iJ0[e, g], dN[g], G)
            w = wJ0[e, g] * J[e, g] * dt
            q, f = J[e, g], supply[i]
            d0, d1, d2 = dE[i, 0] * q + f, dE[i, 1] * q + f, dE[i, 2] * q + f
            d3, d4, d5 = dE[i, 3] * q, dE[i, 4] * q, dE[i, 5] * q
            for a in range(nen):
                h = N[g, a] * w
                row = M[3 * nen + a]
                for b in range(nen):
                    x, y, z = G[0, b], G[1, b], G[2, b]
                    row[b] += h * (d0 * x + d3 * y + d5 * z)
                    row[nen + b] += h * (d3 * x + d1 * y + d4 * z)
                    row[2 * nen + b] += h * (d5 * x + d4 * y + d2 * z)
                    row[3 * nen + b] += h * N[g, b] * dp[i]
