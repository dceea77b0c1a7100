"""Bond families of reactive plasticity where base and yield criterion are isotropic: principal values tell all.

The normal to the yield surface then has the axes of the elastic stretch Ue, and so has the line of states along which
a family returns, U(lam) = Ue (I - lam N) beta: the search of :mod:`.return_map` goes on over three stretches.
Zimmerman, Jiang & Ateshian, J. Biomech. Eng. 143 (2021) 041002.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from .return_map import determinant, parabola_root, product
from .tensors import eigen, right_cauchy_green

NEO_HOOKEAN, NATURAL_NEO_HOOKEAN = range(2)  # bases, of E and v
VON_MISES, DRUCKER_PRAGER, DESHPANDE_FLECK = range(3)  # criteria, of one number
ELASTIC, BEYOND, FRESH = range(3)  # a family below yield, beyond, beyond for the first time
_ROUNDS = 20


@kernel
def principal(law, E, v, u, J, s):
    """Principal stresses s (3,) of the base under principal stretches u (3,), J their product."""
    mu, k = 0.5 * E / (1.0 + v), 1.0 / J
    if law == 0:
        p = E * v / ((1.0 + v) * (1.0 - 2.0 * v)) * math.log(J)
        for a in range(3):
            s[a] = (mu * (u[a] * u[a] - 1.0) + p) * k
    else:
        for a in range(3):  # of a trial too far along the line, stretches may be negative
            s[a] = math.log(abs(u[a]))
        mean = (s[0] + s[1] + s[2]) / 3.0
        p = E / (1.0 - 2.0 * v) * mean
        for a in range(3):
            s[a] = (p + 2.0 * mu * (s[a] - mean)) * k


@kernel
def moduli(law, E, v, u, s, c):
    """Spatial elasticities c (3, 3) among the axes of stretches u, s the principal stresses."""
    mu, J = 0.5 * E / (1.0 + v), u[0] * u[1] * u[2]
    first = E * v / ((1.0 + v) * (1.0 - 2.0 * v))
    for a in range(3):
        for b in range(3):
            c[a, b] = first / J
        if law == 0:
            c[a, a] += 2.0 * (mu - first * math.log(J)) / J
        else:
            c[a, a] += 2.0 * mu / J - 2.0 * s[a]


@kernel
def measured(criterion, q, xx, yy, zz, shear):
    """The yield measure of a stress, ``shear`` the sum of the squares of its shear stresses."""
    mean = (xx + yy + zz) / 3.0
    x, y, z = xx - mean, yy - mean, zz - mean
    mises = math.sqrt(1.5 * (x * x + y * y + z * z + 2.0 * shear))
    if criterion == 1:
        return mises - q * mean
    if criterion == 2:
        return math.sqrt((mises * mises + (3.0 * q * mean) ** 2) / (1.0 + q * q))
    return mises


@kernel
def gradient(criterion, q, s, d):
    """Derivative d (3,) of the measure by principal stresses s. Where there is no stress it is 1, as in FEBio."""
    mean = (s[0] + s[1] + s[2]) / 3.0
    mises = math.sqrt(1.5 * ((s[0] - mean) ** 2 + (s[1] - mean) ** 2 + (s[2] - mean) ** 2))
    if criterion == 2:
        f = 3.0 / math.sqrt((mises * mises + (3.0 * q * mean) ** 2) * (1.0 + q * q))
    elif mises > 2.220446049250313e-16:
        f = 1.5 / mises
    else:
        f = 0.0
    for a in range(3):
        if criterion == 2:
            d[a] = f * (0.5 * (s[a] - mean) + q * q * mean)
        else:
            d[a] = f * (s[a] - mean) if f > 0.0 else 1.0
        if criterion == 1:
            d[a] -= q / (3.0 * math.sqrt(3.0))


@kernel
def normal(law, criterion, E, v, q, u, s, c, d, n):
    """Unit normal n (3,) along the axes of stretches u and stresses s; returns the norm of the derivative by Ue."""
    gradient(criterion, q, s, d)
    moduli(law, E, v, u, s, c)
    inner = d[0] * s[0] + d[1] * s[1] + d[2] * s[2]
    for a in range(3):
        n[a] = (2.0 * d[a] * s[a] - inner + c[a, 0] * d[0] + c[a, 1] * d[1] + c[a, 2] * d[2]) / u[a]
    size = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    for a in range(3):
        n[a] /= size
    return size


@kernel
def place(u, n, V, lam, iso, out):
    """Stretches out (3,) at lam; V = det Us. Returns beta."""
    x, y, z = 1.0 - lam * n[0], 1.0 - lam * n[1], 1.0 - lam * n[2]
    beta = np.cbrt(1.0 / (V * x * y * z)) if iso else 1.0
    out[0], out[1], out[2] = u[0] * x * beta, u[1] * y * beta, u[2] * z * beta
    return beta


@kernel
def measure(law, criterion, E, v, q, to, s):
    """The yield measure under principal stretches ``to``; writes the stresses s."""
    principal(law, E, v, to, to[0] * to[1] * to[2], s)
    return measured(criterion, q, s[0], s[1], s[2], 0.0)


@kernel
def slope(u, n, lam, beta, iso):
    """N : dU/dlam."""
    out = share = 0.0
    if iso:
        for a in range(3):
            share += n[a] / (1.0 - lam * n[a])
        share *= beta / 3.0
    for a in range(3):
        out += n[a] * u[a] * ((1.0 - lam * n[a]) * share - n[a] * beta)
    return out


@kernel
def search(law, criterion, E, v, q, u, n, size, V, trial, Ky, rtol, iso, to, s, l, p, root):
    """Stretches ``to`` (3,) on the yield surface as :func:`.return_map.advance` finds them; returns the last measure.

    ``trial`` is the measure at u.
    """
    lam, phi, other = 0.0, 0.0, np.nan
    for k in range(2 * _ROUNDS):
        beta, value, it = 1.0, trial, k % 3
        if k > 0:
            beta = place(u, n, V, lam, iso, to)
            value = measure(law, criterion, E, v, q, to, s)
        l[it], p[it] = lam, value - Ky
        if it == 2:
            parabola_root(l[0], l[1], l[2], p[0], p[1], p[2], root)
            lam, phi = root[0], root[2]
            if not math.isnan(root[1]):
                other = root[1]
        else:
            phi = p[it]
            lam -= phi / (size * slope(u, n, lam, beta, iso))
        live = not abs(phi) <= rtol
        if k >= _ROUNDS:
            live = live and not math.isnan(other)
            if live:
                lam, other = other, np.nan
        if not live:
            break
    place(u, n, V, lam, iso, to)
    principal(law, E, v, to, to[0] * to[1] * to[2], s)
    return phi + Ky


@kernel
def nearest_root(l1, l2, p0, p1, p2):
    """Root nearest to zero of the parabola through (0, p0), (l1, p1), (l2, p2)."""
    d = l1 * l2 * (l1 - l2)
    if d == 0.0:
        return 0.0 if l1 * l2 == 0.0 else l2
    a = (l2 * (p1 - p0) - l1 * (p2 - p0)) / d
    b = ((p2 - p0) * l1 * l1 - (p1 - p0) * l2 * l2) / d
    disc = b * b - 4.0 * a * p0
    if a == 0.0:
        return -p0 / b if b != 0.0 else 0.0
    if disc < 0.0:
        return -b / (2.0 * a)
    root = math.sqrt(disc)
    r1, r2 = (-b + root) / (2.0 * a), (-b - root) / (2.0 * a)
    return r1 if abs(r1) < abs(r2) else r2


@kernel
def short_search(law, criterion, E, v, q, u, n, size, V, trial, Ky, rtol, iso, to, s, l, p):
    """As :func:`search` for bonds that also fail: two Newton steps and one parabola at most."""
    lam = 0.0
    for k in range(3):
        beta, value = 1.0, trial
        if k > 0:
            beta = place(u, n, V, lam, iso, to)
            value = measure(law, criterion, E, v, q, to, s)
        l[k], p[k] = lam, value - Ky
        step = -p[k] / (size * slope(u, n, lam, beta, iso))
        lam = lam + step if k < 2 else nearest_root(l[1], l[2], p[0], p[1], p[2])
        if abs(step) <= rtol * abs(lam) or abs(lam) <= rtol * rtol:
            break
    place(u, n, V, lam, iso, to)
    return measure(law, criterion, E, v, q, to, s)


@kernel
def add_axes(G, s, out):
    """out (6,) = sum_a s_a G_a dyad G_a, G_a the columns of G."""
    for m in range(6):
        out[m] = 0.0
    for a in range(3):
        x, y, z = G[0, a], G[1, a], G[2, a]
        out[0] += s[a] * x * x
        out[1] += s[a] * y * y
        out[2] += s[a] * z * z
        out[3] += s[a] * x * y
        out[4] += s[a] * y * z
        out[5] += s[a] * x * z


@kernel
def neo_hookean(E, v, F, J, turned, s):
    """Stress s (6,) of a neo-Hookean base under F (3, 3), or by F^T F where ``turned``: back by the rotation of F."""
    mu = 0.5 * E / (1.0 + v)
    g, p = mu / J, E * v / ((1.0 + v) * (1.0 - 2.0 * v)) * math.log(J) / J
    for m in range(6):
        r = m if m < 3 else (0 if m != 4 else 1)
        k = m if m < 3 else (1 if m == 3 else 2)
        if turned:
            x = F[0, r] * F[0, k] + F[1, r] * F[1, k] + F[2, r] * F[2, k]
        else:
            x = F[r, 0] * F[k, 0] + F[r, 1] * F[k, 1] + F[r, 2] * F[k, 2]
        s[m] = g * (x - 1.0) + p if m < 3 else g * x


@kernel
def spectral_stretch(F, i, a, A, w, V, u):
    """Axes V (3, 3; columns) and stretches u (3,) of F[i]."""
    right_cauchy_green(F, i, 1.0, a)
    eigen(a, A, w, V)
    for k in range(3):
        u[k] = math.sqrt(w[k])


@kernel
def back(V, u, power, out):
    """out = V u^power V^T, power 1 or -1."""
    for r in range(3):
        for c in range(3):
            x = 0.0
            for k in range(3):
                x += V[r, k] * (u[k] if power > 0 else 1.0 / u[k]) * V[c, k]
            out[r, c] = x


@kernel
def families(F, J, old, active, Ky, par, q, law, criterion, rtol, iso, short, Us, K, phase, s):
    """Bring each family of bonds back to its yield surface, where it is beyond.

    ``old`` (n, f, columns): inverse plastic part (9), yield measure, ..., the column ``active`` not zero where a
    family may carry load without being beyond yield now. ``Ky`` (1|n, f), ``par`` (1|n, 2) E and v of the base, ``q``
    (1|n,) the number of the criterion; ``short``: the search of bonds that fail. Gives the inverse plastic parts ``Us``
    (n, f, 9), yield measures ``K`` (n, f), ``phase`` (n, f) and the stresses s (n, f + 1, 6), of intact bonds last.
    """
    a, A, w, V, u = np.empty(6), np.empty((3, 3)), np.empty(3), np.empty((3, 3)), np.empty(3)
    U, Ri, T, P = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    Fe, t, c, d, n = np.empty((1, 3, 3)), np.empty(6), np.empty((3, 3)), np.empty(3), np.empty(3)
    to, sp, l, p, root = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    f = Us.shape[1]
    for i in range(len(J)):
        E, v = par[i if len(par) > 1 else 0, 0], par[i if len(par) > 1 else 0, 1]
        number = q[i if len(q) > 1 else 0]
        # R and U^-1 of F = R U; R V turns principal axes to where they are
        spectral_stretch(F, i, a, A, w, V, u)
        back(V, u, -1, U)
        product(F[i], U, Ri)
        if law == 0:
            neo_hookean(E, v, F[i], J[i], False, s[i, f])
        else:
            principal(law, E, v, u, J[i], sp)
            product(Ri, V, T)
            add_axes(T, sp, s[i, f])
        for k in range(f):
            y = Ky[i if len(Ky) > 1 else 0, k]
            Je = 0.0
            for m in range(9):
                Us[i, k, m] = old[i, k, m]
                P[m // 3, m % 3] = old[i, k, m]
            product(F[i], P, Fe[0])
            if law == 0:
                Je = determinant(Fe[0])
                neo_hookean(E, v, Fe[0], Je, True, t)
                trial = measured(criterion, number, t[0], t[1], t[2], t[3] ** 2 + t[4] ** 2 + t[5] ** 2)
            else:
                spectral_stretch(Fe, 0, a, A, w, V, u)
                trial = measure(law, criterion, E, v, number, u, sp)
            K[i, k], phase[i, k] = trial, 0
            if not trial - y > rtol * y:
                if old[i, k, active] == 0.0:
                    for m in range(6):
                        s[i, k, m] = 0.0
                elif law == 0:
                    neo_hookean(E, v, Fe[0], Je, False, s[i, k])
                else:
                    for m in range(3):
                        sp[m] /= u[m] * u[m]
                    product(Fe[0], V, T)
                    add_axes(T, sp, s[i, k])
                continue
            phase[i, k] = 2 if trial > old[i, k, 9] and old[i, k, 9] < y * (1.0 + rtol) else 1
            if law == 0:
                spectral_stretch(Fe, 0, a, A, w, V, u)
                principal(law, E, v, u, u[0] * u[1] * u[2], sp)
            volume, size = determinant(P), normal(law, criterion, E, v, number, u, sp, c, d, n)
            if short:
                K[i, k] = short_search(
                    law, criterion, E, v, number, u, n, size, volume, trial, y, rtol, iso, to, sp, l, p
                )  # fmt: skip
            else:
                K[i, k] = search(
                    law, criterion, E, v, number, u, n, size, volume, trial, y, rtol, iso, to, sp, l, p, root
                )  # fmt: skip
            back(V, to, 1, P)
            product(U, P, T)
            for m in range(9):
                Us[i, k, m] = T[m // 3, m % 3]
            product(Ri, V, T)
            add_axes(T, sp, s[i, k])


@kernel
def yielded(old, Us, K, phase, Ky, share, rtol, s, out, new):
    """Fractions of yielded bonds, the stress of all, out (n, 6) +=, and the state at the present, new (n|0, f, 12).

    ``old`` (n, f, 12): inverse plastic part (9), yield measure, fraction, yielded before; ``share`` (1|n, f + 1).
    """
    f = Us.shape[1]
    for i in range(len(out)):
        intact = 1.0
        for k in range(f):
            y = Ky[i if len(Ky) > 1 else 0, k]
            w, before = old[i, k, 10], old[i, k, 11] > 0.0
            if phase[i, k] == 2:
                w = share[i if len(share) > 1 else 0, k]
            if w > 0.0 and not before and K[i, k] < y / (1.0 + rtol):
                w = 0.0
            intact -= w
            if w != 0.0:
                for m in range(6):
                    out[i, m] += w * s[i, k, m]
            if len(new) > 0:
                for m in range(9):
                    new[i, k, m] = Us[i, k, m]
                new[i, k, 9], new[i, k, 10] = K[i, k], w
                new[i, k, 11] = 1.0 if before or w > 0.0 else 0.0
        for m in range(6):
            out[i, m] += intact * s[i, f, m]
