"""The way back to a yield surface along its normal, point by point: U(lam) = sym(Ue (I - lam N)) beta.

beta = det(Us (I - lam N))^(-1/3) keeps the plastic part isochoric (1 where ``iso`` is 0), Ue is the elastic stretch
beyond yield, Us the inverse of the plastic part so far, N the unit normal; F(lam) = R U(lam). Zimmerman, Jiang &
Ateshian, J. Biomech. Eng. 143 (2021) 041002.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from .tensors import eigen, right_cauchy_green


@kernel
def product(A, B, C):
    """C = A B of 3 x 3 matrices."""
    for r in range(3):
        for c in range(3):
            C[r, c] = A[r, 0] * B[0, c] + A[r, 1] * B[1, c] + A[r, 2] * B[2, c]


@kernel
def determinant(A):
    return (
        A[0, 0] * (A[1, 1] * A[2, 2] - A[1, 2] * A[2, 1])
        - A[0, 1] * (A[1, 0] * A[2, 2] - A[1, 2] * A[2, 0])
        + A[0, 2] * (A[1, 0] * A[2, 1] - A[1, 1] * A[2, 0])
    )


@kernel
def stretches(F, a, A, w, V, U, Ui):
    """U = (F^T F)^1/2 and its inverse; a, A, w, V scratch of :func:`.tensors.eigen`."""
    a[0] = F[0, 0] * F[0, 0] + F[1, 0] * F[1, 0] + F[2, 0] * F[2, 0]
    a[1] = F[0, 1] * F[0, 1] + F[1, 1] * F[1, 1] + F[2, 1] * F[2, 1]
    a[2] = F[0, 2] * F[0, 2] + F[1, 2] * F[1, 2] + F[2, 2] * F[2, 2]
    a[3] = F[0, 0] * F[0, 1] + F[1, 0] * F[1, 1] + F[2, 0] * F[2, 1]
    a[4] = F[0, 1] * F[0, 2] + F[1, 1] * F[1, 2] + F[2, 1] * F[2, 2]
    a[5] = F[0, 0] * F[0, 2] + F[1, 0] * F[1, 2] + F[2, 0] * F[2, 2]
    eigen(a, A, w, V)
    for r in range(3):
        for c in range(3):
            x = y = 0.0
            for k in range(3):
                root = math.sqrt(w[k])
                x += V[r, k] * root * V[c, k]
                y += V[r, k] / root * V[c, k]
            U[r, c], Ui[r, c] = x, y


@kernel
def polar(F, Us, Fe, Je, R, Ue, Ri):
    """Fe = F Us, its determinant, R of F, and Ue and Ri = R_e Ue^-1 of Fe = R_e Ue; all (m, 3, 3) but Je (m,)."""
    a, A, w, V = np.empty(6), np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    U, Ui, Re = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for i in range(len(F)):
        stretches(F[i], a, A, w, V, U, Ui)
        product(F[i], Ui, R[i])
        product(F[i], Us[i], Fe[i])
        Je[i] = determinant(Fe[i])
        stretches(Fe[i], a, A, w, V, Ue[i], Ui)
        product(Fe[i], Ui, Re)
        product(Re, Ui, Ri[i])


@kernel
def normals(s, c, d, Fe, Ue, Ri, N, size):
    """Unit normal N (m, 3, 3) and the norm ``size`` of the derivative of a yield measure by Ue.

    d (m, 3, 3) its derivative by the stress s (m, 6), c (m, 6, 6) the elasticity tensor. The derivative is
    sym(Re^T M Re Ue^-1), M = 2 d s - tr(d s) I + c : d.
    """
    S, M, X, Y = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    v, q = np.empty(6), np.empty(6)
    for i in range(len(s)):
        S[0, 0], S[1, 1], S[2, 2] = s[i, 0], s[i, 1], s[i, 2]
        S[0, 1] = S[1, 0] = s[i, 3]
        S[1, 2] = S[2, 1] = s[i, 4]
        S[0, 2] = S[2, 0] = s[i, 5]
        v[0], v[1], v[2] = d[i, 0, 0], d[i, 1, 1], d[i, 2, 2]
        v[3], v[4], v[5] = 2.0 * d[i, 0, 1], 2.0 * d[i, 1, 2], 2.0 * d[i, 0, 2]
        for p in range(6):
            q[p] = 0.0
            for r in range(6):
                q[p] += c[i, p, r] * v[r]
        product(d[i], S, M)
        tr = M[0, 0] + M[1, 1] + M[2, 2]
        for r in range(3):
            for k in range(3):
                M[r, k] *= 2.0
            M[r, r] += q[r] - tr
        M[0, 1] += q[3]
        M[1, 0] += q[3]
        M[1, 2] += q[4]
        M[2, 1] += q[4]
        M[0, 2] += q[5]
        M[2, 0] += q[5]
        product(M, Ri[i], X)  # M Re Ue^-1
        product(Ri[i], Ue[i], S)  # Re
        for r in range(3):
            for k in range(3):
                Y[r, k] = S[0, r] * X[0, k] + S[1, r] * X[1, k] + S[2, r] * X[2, k]
        square = 0.0
        for r in range(3):
            for k in range(3):
                N[i, r, k] = 0.5 * (Y[r, k] + Y[k, r])
                square += N[i, r, k] ** 2
        size[i] = math.sqrt(square)
        for r in range(3):
            for k in range(3):
                N[i, r, k] /= size[i]


@kernel
def place(R, Ue, N, Us, lam, iso, F, J):
    """F(lam) (m, 3, 3) and its determinant (m,)."""
    L, X, U = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for i in range(len(lam)):
        for r in range(3):
            for k in range(3):
                L[r, k] = -N[i, r, k] * lam[i]
            L[r, r] += 1.0
        beta = 1.0
        if iso:
            product(Us[i], L, X)
            beta = np.cbrt(1.0 / determinant(X))
        product(Ue[i], L, X)
        for r in range(3):
            for k in range(3):
                U[r, k] = 0.5 * (X[r, k] + X[k, r]) * beta
        product(R[i], U, F[i])
        J[i] = determinant(F[i])


@kernel
def slope(Ue, N, Us, lam, iso, i, L, X, Y):
    """N : dU/dlam of point i; L, X, Y scratch."""
    for r in range(3):
        for k in range(3):
            L[r, k] = -N[i, r, k] * lam
        L[r, r] += 1.0
    beta, share = 1.0, 0.0
    if iso:
        product(Us[i], L, X)
        beta = np.cbrt(1.0 / determinant(X))
        # tr(L^-1 N) from the cofactors of L
        for r in range(3):
            r1, r2 = (r + 1) % 3, (r + 2) % 3
            for k in range(3):
                k1, k2 = (k + 1) % 3, (k + 2) % 3
                share += (L[r1, k1] * L[r2, k2] - L[r1, k2] * L[r2, k1]) * N[i, r, k]
        share *= beta / (3.0 * determinant(L))
    product(Ue[i], N[i], X)
    product(Ue[i], L, Y)
    out = 0.0
    for r in range(3):
        for k in range(3):
            out += N[i, r, k] * (Y[r, k] * share - X[r, k] * beta)
    return out


@kernel
def newton(Ue, N, Us, size, lam, phi, iso, out):
    """Steps (m,) of lam towards phi = 0 by the derivative of U along the normal."""
    L, X, Y = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for i in range(len(lam)):
        out[i] = -phi[i] / (size[i] * slope(Ue, N, Us, lam[i], iso, i, L, X, Y))


@kernel
def parabola_root(l0, l1, l2, p0, p1, p2, out):
    """Root of the parabola through three trials, its second root (nan where none), and the parabola there."""
    d = (l0 - l1) * (l0 - l2) * (l1 - l2)
    a = b = c = 0.0
    if d != 0.0:
        a = (l2 * (p1 - p0) + l1 * (p0 - p2) + l0 * (p2 - p1)) / d
        b = (l2**2 * (p0 - p1) + l0**2 * (p1 - p2) + l1**2 * (p2 - p0)) / d
        c = (l0 * l2 * (l2 - l0) * p1 + l1**2 * (l2 * p0 - l0 * p2) + l1 * (p2 * l0**2 - p0 * l2**2)) / d
    disc = b * b - 4.0 * a * c
    lam, other = 0.0, np.nan
    if d == 0.0:  # two coincide
        lam = l1 if l0 == l1 else l2
    elif a == 0.0:
        lam = -c / b if b != 0.0 else 0.0
    elif disc < 0.0:
        sx, sy = l0 + l1 + l2, p0 + p1 + p2
        spread = 3.0 * (l0**2 + l1**2 + l2**2) - sx**2
        rise = (3.0 * (l0 * p0 + l1 * p1 + l2 * p2) - sx * sy) / (spread if spread != 0.0 else 1.0)
        lam = -((sy - rise * sx) / 3.0) / (rise if rise != 0.0 else 1.0)  # of the line through all three
        if lam < 0.0:
            lam = -b / (2.0 * a)
    else:
        root = math.sqrt(disc)
        r1, r2 = (-b + root) / (2.0 * a), (-b - root) / (2.0 * a)
        if r1 * r2 < 0.0:
            lam = max(r1, r2)
        elif abs(r1) < abs(r2):
            lam, other = r1, r2
        else:
            lam, other = r2, r1
    out[0], out[1], out[2] = lam, other, a * lam**2 + b * lam + c


@kernel
def advance(k, rounds, rtol, value, Ue, N, Us, size, iso, lam, phi, other, l, p, live):
    """Round k of the search for lam, ``value`` (m,) being the yield measure less its bound; how many go on.

    Newton's steps, every third replaced by a root of the parabola through the last three (l, p: (3, m)). From round
    ``rounds`` on only second roots (``other``) are tried.
    """
    L, X, Y, root = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    it, left = k % 3, 0
    for i in range(len(lam)):
        if live[i]:
            l[it, i], p[it, i] = lam[i], value[i]
            if it == 2:
                parabola_root(l[0, i], l[1, i], l[2, i], p[0, i], p[1, i], p[2, i], root)
                lam[i], phi[i] = root[0], root[2]
                if not math.isnan(root[1]):
                    other[i] = root[1]
            else:
                phi[i] = value[i]
                lam[i] -= value[i] / (size[i] * slope(Ue, N, Us, lam[i], iso, i, L, X, Y))
            live[i] = not abs(phi[i]) <= rtol
        if k >= rounds:
            live[i] = live[i] and not math.isnan(other[i])
            if live[i]:
                lam[i], other[i] = other[i], np.nan
        if live[i]:
            left += 1
    return left


@kernel
def mises(s, measure, gradient):
    """von Mises stress (m,) of s (m, 6), and where asked for its derivative by the stress (m, 3, 3).

    Where there is no stress the derivative is the identity, as FEBio has it.
    """
    for i in range(len(s)):
        mean = (s[i, 0] + s[i, 1] + s[i, 2]) / 3.0
        x, y, z = s[i, 0] - mean, s[i, 1] - mean, s[i, 2] - mean
        xy, yz, xz = s[i, 3], s[i, 4], s[i, 5]
        measure[i] = math.sqrt(1.5 * (x * x + y * y + z * z + 2.0 * (xy * xy + yz * yz + xz * xz)))
        if len(gradient) == 0:
            continue
        g = gradient[i]
        if measure[i] > 2.220446049250313e-16:
            f = 1.5 / measure[i]
            g[0, 0], g[1, 1], g[2, 2] = f * x, f * y, f * z
            g[0, 1] = g[1, 0] = f * xy
            g[1, 2] = g[2, 1] = f * yz
            g[0, 2] = g[2, 0] = f * xz
        else:
            for r in range(3):
                for k in range(3):
                    g[r, k] = 1.0 if r == k else 0.0


@kernel
def octahedral(F, out):
    """Octahedral shear strain (2/3 dev E : dev E)^1/2 of deformation gradients F (n, 3, 3), out (n,)."""
    a = np.empty(6)
    for i in range(len(out)):
        right_cauchy_green(F, i, 0.5, a)
        mean = (a[0] + a[1] + a[2]) / 3.0
        x, y, z = a[0] - mean, a[1] - mean, a[2] - mean
        shear = a[3] * a[3] + a[4] * a[4] + a[5] * a[5]
        out[i] = math.sqrt((x * x + y * y + z * z + 2.0 * shear) / 1.5)
