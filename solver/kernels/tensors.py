"""Symmetric second-order and fourth-order tensors in Voigt order xx yy zz xy yz xz, for use inside kernels.

Second-order tensors are scratch arrays of six numbers that the caller allocates once, before its loop.
``add_*`` functions add ``k`` times a fourth-order tensor to ``c[i]`` of an array (n, 6, 6); with the
products (a dyad b)_ijkl = a_ij b_kl and (a circle b)_ijkl = (a_ik b_jl + a_il b_jk) / 2.
"""

from __future__ import annotations

import math

from ..jit import kernel


@kernel
def left_cauchy_green(F, i, k, b):
    """b = k F F^T of point ``i``."""
    for p in range(3):
        b[p] = k * (F[i, p, 0] * F[i, p, 0] + F[i, p, 1] * F[i, p, 1] + F[i, p, 2] * F[i, p, 2])
    b[3] = k * (F[i, 0, 0] * F[i, 1, 0] + F[i, 0, 1] * F[i, 1, 1] + F[i, 0, 2] * F[i, 1, 2])
    b[4] = k * (F[i, 1, 0] * F[i, 2, 0] + F[i, 1, 1] * F[i, 2, 1] + F[i, 1, 2] * F[i, 2, 2])
    b[5] = k * (F[i, 0, 0] * F[i, 2, 0] + F[i, 0, 1] * F[i, 2, 1] + F[i, 0, 2] * F[i, 2, 2])


@kernel
def right_cauchy_green(F, i, k, b):
    """C = k F^T F of point ``i``."""
    for p in range(3):
        b[p] = k * (F[i, 0, p] * F[i, 0, p] + F[i, 1, p] * F[i, 1, p] + F[i, 2, p] * F[i, 2, p])
    b[3] = k * (F[i, 0, 0] * F[i, 0, 1] + F[i, 1, 0] * F[i, 1, 1] + F[i, 2, 0] * F[i, 2, 1])
    b[4] = k * (F[i, 0, 1] * F[i, 0, 2] + F[i, 1, 1] * F[i, 1, 2] + F[i, 2, 1] * F[i, 2, 2])
    b[5] = k * (F[i, 0, 0] * F[i, 0, 2] + F[i, 1, 0] * F[i, 1, 2] + F[i, 2, 0] * F[i, 2, 2])


@kernel
def square(a, out):
    """out = a a."""
    out[0] = a[0] * a[0] + a[3] * a[3] + a[5] * a[5]
    out[1] = a[3] * a[3] + a[1] * a[1] + a[4] * a[4]
    out[2] = a[5] * a[5] + a[4] * a[4] + a[2] * a[2]
    out[3] = a[0] * a[3] + a[3] * a[1] + a[5] * a[4]
    out[4] = a[3] * a[5] + a[1] * a[4] + a[4] * a[2]
    out[5] = a[0] * a[5] + a[3] * a[4] + a[5] * a[2]


@kernel
def trace(a):
    return a[0] + a[1] + a[2]


@kernel
def determinant(a):
    return (
        a[0] * (a[1] * a[2] - a[4] * a[4])
        - a[3] * (a[3] * a[2] - a[4] * a[5])
        + a[5] * (a[3] * a[4] - a[1] * a[5])
    )


@kernel
def inner(a, b):
    """a : b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])


@kernel
def symmetric_product(a, b, out):
    """out = (a b + b a) / 2."""
    out[0] = a[0] * b[0] + a[3] * b[3] + a[5] * b[5]
    out[1] = a[3] * b[3] + a[1] * b[1] + a[4] * b[4]
    out[2] = a[5] * b[5] + a[4] * b[4] + a[2] * b[2]
    out[3] = 0.5 * (a[0] * b[3] + a[3] * b[1] + a[5] * b[4] + b[0] * a[3] + b[3] * a[1] + b[5] * a[4])
    out[4] = 0.5 * (a[3] * b[5] + a[1] * b[4] + a[4] * b[2] + b[3] * a[5] + b[1] * a[4] + b[4] * a[2])
    out[5] = 0.5 * (a[0] * b[5] + a[3] * b[4] + a[5] * b[2] + b[0] * a[5] + b[3] * a[4] + b[5] * a[2])


@kernel
def dyad_of(x, y, z, out):
    """out = v v^T."""
    out[0] = x * x
    out[1] = y * y
    out[2] = z * z
    out[3] = x * y
    out[4] = y * z
    out[5] = x * z


@kernel
def add_identity(c, i, k1, k4):
    """k1 (I dyad I) + k4 (I circle I)."""
    for p in range(3):
        for q in range(3):
            c[i, p, q] += k1
        c[i, p, p] += k4
        c[i, p + 3, p + 3] += 0.5 * k4


@kernel
def add_dyad(c, i, k, a):
    """k (a dyad a)."""
    for p in range(6):
        ka = k * a[p]
        for q in range(6):
            c[i, p, q] += ka * a[q]


@kernel
def add_dyads(c, i, k, a, b):
    """k (a dyad b + b dyad a)."""
    for p in range(6):
        ka = k * a[p]
        kb = k * b[p]
        for q in range(6):
            c[i, p, q] += ka * b[q] + kb * a[q]


@kernel
def add_dyad_identity(c, i, k, a):
    """k (a dyad I + I dyad a)."""
    for p in range(6):
        ka = k * a[p]
        for q in range(3):
            c[i, p, q] += ka
            c[i, q, p] += ka


@kernel
def _put(c, i, p, q, x):
    c[i, p, q] += x
    c[i, q, p] += x


@kernel
def add_circle(c, i, k, a):
    """k (a circle a)."""
    xx, yy, zz, xy, yz, xz = a[0], a[1], a[2], a[3], a[4], a[5]
    h = 0.5 * k
    c[i, 0, 0] += k * xx * xx
    c[i, 1, 1] += k * yy * yy
    c[i, 2, 2] += k * zz * zz
    c[i, 3, 3] += h * (xx * yy + xy * xy)
    c[i, 4, 4] += h * (yy * zz + yz * yz)
    c[i, 5, 5] += h * (xx * zz + xz * xz)
    _put(c, i, 0, 1, k * xy * xy)
    _put(c, i, 0, 2, k * xz * xz)
    _put(c, i, 1, 2, k * yz * yz)
    _put(c, i, 0, 3, k * xx * xy)
    _put(c, i, 1, 3, k * xy * yy)
    _put(c, i, 2, 3, k * xz * yz)
    _put(c, i, 0, 4, k * xy * xz)
    _put(c, i, 1, 4, k * yy * yz)
    _put(c, i, 2, 4, k * yz * zz)
    _put(c, i, 0, 5, k * xx * xz)
    _put(c, i, 1, 5, k * xy * yz)
    _put(c, i, 2, 5, k * xz * zz)
    _put(c, i, 3, 4, h * (xy * yz + xz * yy))
    _put(c, i, 3, 5, h * (xx * yz + xy * xz))
    _put(c, i, 4, 5, h * (xy * zz + xz * yz))


@kernel
def add_circles(c, i, k, a, b):
    """k (a circle b + b circle a)."""
    axx, ayy, azz, axy, ayz, axz = a[0], a[1], a[2], a[3], a[4], a[5]
    bxx, byy, bzz, bxy, byz, bxz = b[0], b[1], b[2], b[3], b[4], b[5]
    h = 0.5 * k
    c[i, 0, 0] += 2.0 * k * axx * bxx
    c[i, 1, 1] += 2.0 * k * ayy * byy
    c[i, 2, 2] += 2.0 * k * azz * bzz
    c[i, 3, 3] += h * (axx * byy + 2.0 * axy * bxy + bxx * ayy)
    c[i, 4, 4] += h * (ayy * bzz + 2.0 * ayz * byz + byy * azz)
    c[i, 5, 5] += h * (axx * bzz + 2.0 * axz * bxz + bxx * azz)
    _put(c, i, 0, 1, 2.0 * k * axy * bxy)
    _put(c, i, 0, 2, 2.0 * k * axz * bxz)
    _put(c, i, 1, 2, 2.0 * k * ayz * byz)
    _put(c, i, 0, 3, k * (axx * bxy + bxx * axy))
    _put(c, i, 1, 3, k * (axy * byy + bxy * ayy))
    _put(c, i, 2, 3, k * (axz * byz + bxz * ayz))
    _put(c, i, 0, 4, k * (axy * bxz + bxy * axz))
    _put(c, i, 1, 4, k * (ayy * byz + byy * ayz))
    _put(c, i, 2, 4, k * (ayz * bzz + byz * azz))
    _put(c, i, 0, 5, k * (axx * bxz + bxx * axz))
    _put(c, i, 1, 5, k * (axy * byz + bxy * ayz))
    _put(c, i, 2, 5, k * (axz * bzz + bxz * azz))
    _put(c, i, 3, 4, h * (axy * byz + axz * byy + bxy * ayz + bxz * ayy))
    _put(c, i, 3, 5, h * (axx * byz + axy * bxz + bxx * ayz + bxy * axz))
    _put(c, i, 4, 5, h * (axy * bzz + axz * byz + bxy * azz + bxz * ayz))


@kernel
def add_deviatoric_stress(s, i, k, T):
    """s[i] += k dev T."""
    m = (T[0] + T[1] + T[2]) / 3.0
    for p in range(3):
        s[i, p] += k * (T[p] - m)
        s[i, p + 3] += k * T[p + 3]


@kernel
def add_deviatoric_tangent(c, i, k, T, h):
    """Tangent of dev T where T(F~) is a stress of the distortional F~ = J^-1/3 F and h[0] its tangent.

    P : h : P + 2/3 [tr T (I circle I - I dyad I / 3) - (I dyad dev T + dev T dyad I)], times k
    (Holzapfel, Nonlinear Solid Mechanics, 6.169).
    """
    t = T[0] + T[1] + T[2]
    whole = 0.0
    for p in range(3):
        for q in range(3):
            whole += h[0, p, q]
    m = t / 3.0
    for p in range(6):
        hp = (h[0, p, 0] + h[0, p, 1] + h[0, p, 2]) / 3.0
        hp += 2.0 / 3.0 * (T[p] - m if p < 3 else T[p])
        for q in range(6):
            c[i, p, q] += k * h[0, p, q]
        for q in range(3):
            c[i, p, q] -= k * hp
            c[i, q, p] -= k * hp
    add_identity(c, i, k * (whole / 9.0 - 2.0 / 9.0 * t), k * 2.0 / 3.0 * t)


@kernel
def clear(T, h):
    """Set a scratch stress (6,) and tangent (1, 6, 6) to zero."""
    for p in range(6):
        T[p] = 0.0
        for q in range(6):
            h[0, p, q] = 0.0


@kernel
def eigen(a, A, w, V):
    """Eigenvalues w (3,) and vectors V (3, 3; columns) of a (6,) by Jacobi rotations; A (3, 3) scratch."""
    A[0, 0], A[1, 1], A[2, 2] = a[0], a[1], a[2]
    A[0, 1] = A[1, 0] = a[3]
    A[1, 2] = A[2, 1] = a[4]
    A[0, 2] = A[2, 0] = a[5]
    for p in range(3):
        for q in range(3):
            V[p, q] = 1.0 if p == q else 0.0
    for _ in range(50):
        off = abs(A[0, 1]) + abs(A[0, 2]) + abs(A[1, 2])
        if off <= 1e-300:
            break
        for p in range(2):
            for q in range(p + 1, 3):
                g = A[p, q]
                h = A[q, q] - A[p, p]
                if g == 0.0:
                    continue
                x, y = abs(A[p, p]), abs(A[q, q])
                if x + 100.0 * abs(g) == x and y + 100.0 * abs(g) == y:  # less than rounding of both values
                    A[p, q] = A[q, p] = 0.0
                    continue
                if abs(h) + 100.0 * abs(g) == abs(h):
                    t = g / h
                else:
                    th = 0.5 * h / g
                    t = 1.0 / (abs(th) + math.sqrt(1.0 + th * th))
                    if th < 0.0:
                        t = -t
                co = 1.0 / math.sqrt(1.0 + t * t)
                si = t * co
                A[p, p] -= t * g
                A[q, q] += t * g
                A[p, q] = A[q, p] = 0.0
                r = 3 - p - q
                x, y = A[r, p], A[r, q]
                A[r, p] = A[p, r] = co * x - si * y
                A[r, q] = A[q, r] = si * x + co * y
                for r in range(3):
                    x, y = V[r, p], V[r, q]
                    V[r, p] = co * x - si * y
                    V[r, q] = si * x + co * y
    for p in range(3):
        w[p] = A[p, p]


@kernel
def merge_close(w, eps):
    """Make eigenvalues closer than ``eps`` equal."""
    if abs(w[0] - w[1]) < eps:
        w[1] = w[0]
    if abs(w[0] - w[2]) < eps:
        w[2] = w[0]
    if abs(w[1] - w[2]) < eps:
        w[2] = w[1]
