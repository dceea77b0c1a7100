"""Rigid bodies: rotations as unit quaternions (x, y, z, w), Newmark's rates, inertia; see :mod:`..rigid.bodies`.

``rows`` (body,): first of a body's two rows in nodal arrays, that of its centre; that of its rotation follows.
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel


@kernel
def product(a, b, c, w, x, y, z, v):
    """(a, b, c, w) (x, y, z, v): the second rotation, then the first."""
    return (
        w * x + a * v + b * z - c * y, w * y + b * v + c * x - a * z,
        w * z + c * v + a * y - b * x, w * v - a * x - b * y - c * z,
    )  # fmt: skip


@kernel
def unit(x, y, z, w):
    """A quaternion made one of length 1."""
    n = np.sqrt(x * x + y * y + z * z + w * w)
    return x / n, y / n, z / n, w / n


@kernel
def turn(x, y, z, w, a, b, c):
    """The vector (a, b, c) turned by a quaternion."""
    return (
        (w * w + x * x - y * y - z * z) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c,
        2 * (x * y + w * z) * a + (w * w - x * x + y * y - z * z) * b + 2 * (y * z - w * x) * c,
        2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (w * w - x * x - y * y + z * z) * c,
    )


@kernel
def since(q, q_old):
    """The rotation (4,) since an earlier one."""
    x, y, z, w = product(q[0], q[1], q[2], q[3], -q_old[0], -q_old[1], -q_old[2], q_old[3])
    return unit(x, y, z, w)


@kernel
def of_cayley(a, b, c):
    """The rotation of a Cayley vector."""
    return unit(0.5 * a, 0.5 * b, 0.5 * c, 1.0)


@kernel
def spatial(q, I, J):
    """J = Q I Q^T (3, 3), the inertia in the present orientation."""
    T = np.empty((3, 3))
    for j in range(3):
        T[0, j], T[1, j], T[2, j] = turn(q[0], q[1], q[2], q[3], I[0, j], I[1, j], I[2, j])
    for i in range(3):
        J[i, 0], J[i, 1], J[i, 2] = turn(q[0], q[1], q[2], q[3], T[i, 0], T[i, 1], T[i, 2])


@kernel
def rates(rows, dt, beta, gamma, q, q_old, u, u_old, v, v_old, a, a_old):
    """Velocities v and accelerations a of bodies (node, 3) at their present place, from those of the last step."""
    k, c, m = 1.0 / (beta * dt), 1.0 - 0.5 / beta, 2.0 - gamma / beta
    for i in range(len(rows)):
        t = rows[i]
        r = t + 1
        for j in range(3):
            a[t, j] = (u[t, j] - u_old[t, j]) * (k / dt) - v_old[t, j] * k + a_old[t, j] * c
            v[t, j] = v_old[t, j] + dt * ((1.0 - gamma) * a_old[t, j] + gamma * a[t, j])
        x, y, z, w = since(q[i], q_old[i])
        spin, push = np.empty(3), np.empty(3)
        for j in range(3):
            theta = 2.0 * (x if j == 0 else y if j == 1 else z) / w
            spin[j] = theta * (k * gamma) - v_old[r, j] + (v_old[r, j] + 0.5 * dt * a_old[r, j]) * m
            push[j] = theta * (k / dt) - v_old[r, j] * k + a_old[r, j] * c
        v[r, 0], v[r, 1], v[r, 2] = turn(x, y, z, w, spin[0], spin[1], spin[2])
        a[r, 0], a[r, 1], a[r, 2] = turn(x, y, z, w, push[0], push[1], push[2])


@kernel
def inertia(rows, alpham, mass, I, q, v, a, a_old, dh_old, h, dh, R):
    """R -= m a and the rate dh of the angular momentum h (body, 3), dh = w x J w + J w'."""
    J = np.empty((3, 3))
    for i in range(len(rows)):
        t = rows[i]
        r = t + 1
        for j in range(3):
            R[t, j] -= mass[i] * (alpham * a[t, j] + (1.0 - alpham) * a_old[t, j])
        spatial(q[i], I[i], J)
        for j in range(3):
            h[i, j] = J[j, 0] * v[r, 0] + J[j, 1] * v[r, 1] + J[j, 2] * v[r, 2]
        for j in range(3):
            k, l = (j + 1) % 3, (j + 2) % 3
            dh[i, j] = v[r, k] * h[i, l] - v[r, l] * h[i, k] + (
                J[j, 0] * a[r, 0] + J[j, 1] * a[r, 1] + J[j, 2] * a[r, 2]
            )
            R[r, j] -= alpham * dh[i, j] + (1.0 - alpham) * dh_old[i, j]


@kernel
def skew(x, S):
    """S (3, 3) with S a = x cross a."""
    S[0, 0] = S[1, 1] = S[2, 2] = 0.0
    S[0, 1], S[0, 2], S[1, 2] = -x[2], x[1], -x[0]
    S[1, 0], S[2, 0], S[2, 1] = x[2], -x[1], x[0]


@kernel
def inertia_tangent(rows, dt, beta, gamma, alpham, a, mass, I, q, q_old, v, h, dh, K):
    """Minus the derivatives K (body, 6, 6) of the inertia forces by shifts and rotations; ``a``: per unit of mass."""
    J, T, A, W, H, D = (np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)),
                        np.empty((3, 3)))  # fmt: skip
    theta = np.empty(3)
    for i in range(len(rows)):
        K[i] = 0.0
        for j in range(3):
            K[i, j, j] = mass[i] * a
        x, y, z, w = since(q[i], q_old[i])
        theta[0], theta[1], theta[2] = 2.0 * x / w, 2.0 * y / w, 2.0 * z / w
        spatial(q[i], I[i], J)
        skew(theta, T)
        skew(v[rows[i] + 1], W)
        skew(h[i], H)
        skew(dh[i], D)
        for j in range(3):
            for k in range(3):
                T[j, k] = 0.5 * T[j, k] + 0.25 * theta[j] * theta[k]
                A[j, k] = -gamma * H[j, k]
                W[j, k] *= gamma
            T[j, j] += 1.0
            W[j, j] += 1.0 / dt
        for j in range(3):
            for k in range(3):
                A[j, k] += W[j, 0] * J[0, k] + W[j, 1] * J[1, k] + W[j, 2] * J[2, k]
        for j in range(3):
            for k in range(3):
                rate = A[j, 0] * T[0, k] + A[j, 1] * T[1, k] + A[j, 2] * T[2, k]
                K[i, 3 + j, 3 + k] = alpham * (rate / (beta * dt) - D[j, k])


@kernel
def move(rows, eq, given, increment, u, q_old, q, d):
    """Rotations q of bodies: by the increment so far and then ``u`` (equations), or as prescribed (``given``).

    eq, given (body, 3): equations of the rotations, -1 where there is none, and which are prescribed; d (node, 3):
    displacements, at the rows of rotations the rotation vector.
    """
    t = np.empty(3)
    for i in range(len(rows)):
        r = rows[i] + 1
        some = prescribed = False
        for j in range(3):
            some |= eq[i, j] >= 0
            prescribed |= given[i, j]
        if prescribed:
            for j in range(3):
                t[j] = d[r, j] if given[i, j] else 0.0
                d[r, j] = t[j]
            angle = np.sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
            s = np.sin(0.5 * angle) / angle if angle > 0 else 0.5
            q[i, 0], q[i, 1], q[i, 2], q[i, 3] = s * t[0], s * t[1], s * t[2], np.cos(0.5 * angle)
            continue
        if not some:
            continue
        x, y, z, w = composed(eq[i], increment, u)
        x, y, z, w = product(x, y, z, w, q_old[i, 0], q_old[i, 1], q_old[i, 2], q_old[i, 3])
        q[i, 0], q[i, 1], q[i, 2], q[i, 3] = unit(x, y, z, w)
        s = np.sqrt(q[i, 0] * q[i, 0] + q[i, 1] * q[i, 1] + q[i, 2] * q[i, 2])
        scale = 2.0 * np.arctan2(s, q[i, 3]) / s if s > 0 else 0.0
        for j in range(3):
            d[r, j] = q[i, j] * scale


@kernel
def composed(e, a, b):
    """The rotation of Cayley vectors at equations e (3,) of a, then of b; -1: zero."""
    p, q = np.zeros(3), np.zeros(3)
    for j in range(3):
        if e[j] >= 0:
            p[j], q[j] = a[e[j]], b[e[j]]
    x, y, z, w = of_cayley(p[0], p[1], p[2])
    k, l, m, n = of_cayley(q[0], q[1], q[2])
    return product(k, l, m, n, x, y, z, w)


@kernel
def compose(eq, a, b, total):
    """``total`` (equations) at rotations: the Cayley vector of a, then of b."""
    for i in range(len(eq)):
        if eq[i, 0] < 0 and eq[i, 1] < 0 and eq[i, 2] < 0:
            continue
        x, y, z, w = composed(eq[i], a, b)
        for j in range(3):
            if eq[i, j] >= 0:
                total[eq[i, j]] = 2.0 * (x if j == 0 else y if j == 1 else z) / w


@kernel
def carry(nodes, at, body, arm, q, X, d):
    """Displacements d (node, 3) of carried ``nodes`` (k,) with arms (k, 3) of bodies ``body`` whose centres are rows
    ``at``."""
    for k in range(len(nodes)):
        n, c, p = nodes[k], at[k], q[body[k]]
        x, y, z = turn(p[0], p[1], p[2], p[3], arm[k, 0], arm[k, 1], arm[k, 2])
        d[n, 0] = X[c, 0] + d[c, 0] + x - X[n, 0]
        d[n, 1] = X[c, 1] + d[c, 1] + y - X[n, 1]
        d[n, 2] = X[c, 2] + d[c, 2] + z - X[n, 2]


@kernel
def weights(nodes, at, alpha, X, u, u_old, out):
    """What a carried node's shifts take of its masters (k, 3, 3): 1, z_k, -z_j; z from the centre, at a time ``alpha``
    between the last step and the present."""
    z = np.empty(3)
    for k in range(len(nodes)):
        n, c = nodes[k], at[k]
        for i in range(3):
            dn = u[n, i] if alpha == 1.0 else alpha * u[n, i] + (1.0 - alpha) * u_old[n, i]
            dc = u[c, i] if alpha == 1.0 else alpha * u[c, i] + (1.0 - alpha) * u_old[c, i]
            z[i] = X[n, i] + dn - X[c, i] - dc
        for i in range(3):
            out[k, i, 0], out[k, i, 1], out[k, i, 2] = 1.0, z[(i + 2) % 3], -z[(i + 1) % 3]
