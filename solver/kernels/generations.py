"""Generations of bonds: when they begin, what they weigh, and deformation as seen from the states at their birth.

A state is a row of ten numbers, the count of generations and F of the last state, and of eleven for each generation:
time v at which it starts to break, J, fraction, recruited, distortion |dev ln U|, U (xx yy zz xy yz xz).
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel
from .return_map import determinant, product
from .tensors import (
    add_circle,
    add_deviatoric_stress,
    add_deviatoric_tangent,
    add_dyad,
    add_identity,
    clear,
    eigen,
    left_cauchy_green,
    right_cauchy_green,
    square,
    trace,
)


@kernel
def shear_of(w):
    """|dev ln| of stretches, w (3,) their squares."""
    x, y, z = 0.5 * math.log(max(w[0], 1e-300)), 0.5 * math.log(max(w[1], 1e-300)), 0.5 * math.log(max(w[2], 1e-300))
    mean = (x + y + z) / 3.0
    return math.sqrt((x - mean) ** 2 + (y - mean) ** 2 + (z - mean) ** 2)


@kernel
def strain_measure(F, i, trigger, a, A, w, V):
    """|E| (``trigger`` 0), |dev ln V| (1) or |ln J| (2) of F[i]; a, A, w, V scratch of :func:`.tensors.eigen`."""
    if trigger == 0:
        right_cauchy_green(F, i, 1.0, a)
        x, y, z = 0.5 * (a[0] - 1.0), 0.5 * (a[1] - 1.0), 0.5 * (a[2] - 1.0)
        return math.sqrt(x * x + y * y + z * z + 0.5 * (a[3] * a[3] + a[4] * a[4] + a[5] * a[5]))
    if trigger == 1:
        left_cauchy_green(F, i, 1.0, a)
        eigen(a, A, w, V)
        return shear_of(w)
    return abs(math.log(determinant(F[i])))


@kernel
def strain_measures(F, trigger, out):
    """:func:`strain_measure` of all points, out (n,)."""
    a, A, w, V = np.empty(6), np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    for i in range(len(out)):
        out[i] = strain_measure(F, i, trigger, a, A, w, V)


@kernel
def inverse_of(U, out):
    """Inverse (3, 3) of a symmetric U (6,)."""
    x, y, z, xy, yz, xz = U[0], U[1], U[2], U[3], U[4], U[5]
    c0, c1, c2 = y * z - yz * yz, xz * yz - xy * z, xy * yz - xz * y
    d = 1.0 / (x * c0 + xy * c1 + xz * c2)
    out[0, 0], out[1, 1], out[2, 2] = c0 * d, (x * z - xz * xz) * d, (x * y - xy * xy) * d
    out[0, 1] = out[1, 0] = c1 * d
    out[0, 2] = out[2, 0] = c2 * d
    out[1, 2] = out[2, 1] = (xy * xz - x * yz) * d


@kernel
def merged(old, w, count, wmin):
    """Do the first two generations of a state merge, ``count`` with the one that begins? w (generation,) fractions."""
    return count >= 3 and w[0] * old[13] < wmin


@kernel
def ages(gen, t, out):
    """Times out (n, g) since generations started to break, 0 before; are they those of the first point everywhere?"""
    same = True
    for i in range(out.shape[0]):
        for k in range(out.shape[1]):
            out[i, k] = max(t - gen[i, k, 0], 0.0)
            same = same and out[i, k] == out[0, k]
    return same


@kernel
def fractions(gen, t, g, before, count, out):
    """Mass fractions out (n, m) of generations that have relaxed to g (1|n, m).

    Where ``before`` (1|n, m - 1) has rows they are of type II: it holds what the generation before each would have
    relaxed to, had it formed in the same state. ``count`` (0|n,): recruited bonds count, and the generations there
    are; all is of the first where there is none.
    """
    for i in range(out.shape[0]):
        a, b = i if len(g) > 1 else 0, i if len(before) > 1 else 0
        for k in range(out.shape[1]):
            if len(before) == 0:
                x = gen[i, k, 2] * g[a, k] if t >= gen[i, k, 0] else 0.0
            else:
                x = g[a, k] - before[b, k - 1] if k > 0 else g[a, k]
            if len(count) > 0:
                x = x * gen[i, k, 3] if k < count[i] else 0.0
            out[i, k] = x
        if len(count) > 0 and count[i] == 0.0:
            out[i, 0] = 1.0


@kernel
def there(old, new, count, shift):
    """Did an earlier iterate leave the generations of ``old``, past the first where they are shifted, in ``new``?"""
    a, b = 10 + 11 * shift, 11 * (count - shift) - 1  # the times at which the first and the last start to break
    if b < a:
        return True
    s = 11 * shift
    same = new[a] == old[a + s] and new[a + 1] == old[a + s + 1]
    return same and new[b] == old[b + s] and new[b + 1] == old[b + s + 1]


@kernel
def begin(F, i, J, t, share, fraction, a, A, w, V, at, new):
    """Write the generation that begins in the state F[i], J into new from column ``at`` on."""
    right_cauchy_green(F, i, 1.0, a)
    eigen(a, A, w, V)
    new[at], new[at + 1], new[at + 2], new[at + 3], new[at + 4] = t, J, fraction, share, shear_of(w)
    for m in range(6):
        r = m if m < 3 else (0 if m != 4 else 1)
        c = m if m < 3 else (1 if m == 3 else 2)
        new[at + 5 + m] = 0.0
        for k in range(3):
            new[at + 5 + m] += V[r, k] * math.sqrt(w[k]) * V[c, k]


@kernel
def merge(old, w, a, A, l, V, new):
    """Write the mean of the first two generations of ``old``, by what they weigh, as the first of ``new``."""
    p, q = w[0] * old[13], w[1] * old[24]
    for m in range(11):
        new[10 + m] = (p * old[10 + m] + q * old[21 + m]) / (p + q)
    x, y, z, xy, yz, xz = new[15], new[16], new[17], new[18], new[19], new[20]
    new[11] = x * (y * z - yz * yz) - xy * (xy * z - yz * xz) + xz * (xy * yz - y * xz)
    a[0], a[1], a[2] = x * x + xy * xy + xz * xz, xy * xy + y * y + yz * yz, xz * xz + yz * yz + z * z
    a[3], a[4], a[5] = x * xy + xy * y + xz * yz, xy * xz + y * yz + yz * z, x * xz + xy * yz + xz * z
    eigen(a, A, l, V)
    new[14] = shear_of(l)


@kernel
def grow(F, J, t, old, w, share, slack, par, trigger, culls, again, new):
    """Bring states from ``old`` to ``new`` (n, columns): a generation begins where the strain has changed.

    ``w`` (n, generations) fractions of those of ``old`` now; ``share`` (n,) recruited by one that begins; ``slack``
    (n,) where none may; ``par`` (1|n, 2) least fraction that reforms, least strain; ``culls``: generations merge where
    they have less than that. ``again``: ``new`` is of an earlier iterate of the step, what began there stays begun.
    """
    a, A, l, V = np.empty(6), np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    G, Ui = np.empty((1, 3, 3)), np.empty((3, 3))
    for i in range(len(J)):
        m = i if len(par) > 1 else 0
        wmin, emin = par[m, 0], max(par[m, 1], 2.220446049250313e-15)
        count, last = int(old[i, 0]), 0.0
        before = int(new[i, 0]) if again else 0
        begun = before > 0 and new[i, 11 * before - 1] == t
        if begun and slack[i]:
            for k in range(9):
                new[i, 1 + k] = F[i, k // 3, k % 3]
            continue
        left = 1.0
        for k in range(count):
            last = w[i, k]
            left -= last
        born = begun
        if not begun and (count == 0 or old[i, 11 * count - 1] < t) and not (culls and left + last < wmin):
            if count == 0:
                change = strain_measure(F, i, trigger, a, A, l, V)
            else:
                inverse_of(old[i, 11 * count + 4 : 11 * count + 10], Ui)
                product(F[i], Ui, G[0])
                change = strain_measure(G, 0, trigger, a, A, l, V)
            born = change > emin
        born = born and not slack[i]
        shift = 1 if born and culls and merged(old[i], w[i], count + 1, wmin) else 0
        if shift:
            merge(old[i], w[i], a, A, l, V, new[i])
        if not (again and there(old[i], new[i], count, shift)):
            for k in range(10 + 11 * shift, 10 + 11 * (count - shift)):
                new[i, k] = old[i, k + 11 * shift]
        if born:
            begin(F, i, J[i], t, share[i], left, a, A, l, V, 10 + 11 * (count - shift), new[i])
        new[i, 0] = count - shift + (1 if born else 0)
        for k in range(9):
            new[i, 1 + k] = F[i, k // 3, k % 3]


@kernel
def add_neo_hookean(F, J, gen, count, w, par, intact, rest, s, c):
    """Add stress and tangent of neo-Hookean bonds, ``par`` (1|n, 2) E and v, as :func:`since_birth` and their law give.

    ``gen`` (n, generation, 11), ``w`` (n, g) what each weighs, ``intact`` (n,) of all; ``rest``: no stress. Tangents of
    generations differ by two numbers, stresses by F B F^T, B = sum_g k_g U_g^-2.
    """
    Ui, B = np.empty((3, 3)), np.empty((3, 3))
    for i in range(len(J)):
        m = i if len(par) > 1 else 0
        E, v = par[m, 0], par[m, 1]
        first, mu = E * v / ((1.0 + v) * (1.0 - 2.0 * v)), 0.5 * E / (1.0 + v)
        k1 = k4 = pressure = shear = 0.0
        for r in range(3):
            for k in range(3):
                B[r, k] = 0.0
        for g in range(w.shape[1]):
            if w[i, g] == 0.0:
                continue
            born = 0 < g < count[i]
            Jb = gen[i, g - 1, 1] if born else 1.0
            k, Jg = intact[i] * w[i, g] / Jb, J[i] / Jb
            p, h = first * math.log(Jg) / Jg, mu / Jg
            k1 += k * first / Jg
            k4 += 2.0 * k * (h - p)
            pressure += k * p
            shear += k * h
            if not born:
                for r in range(3):
                    B[r, r] += k * h
                continue
            inverse_of(gen[i, g - 1, 5:11], Ui)
            for r in range(3):
                for q in range(r + 1):
                    B[r, q] += k * h * (Ui[r, 0] * Ui[q, 0] + Ui[r, 1] * Ui[q, 1] + Ui[r, 2] * Ui[q, 2])
        if not rest:
            for m in range(6):
                r = m if m < 3 else (0 if m != 4 else 1)
                k = m if m < 3 else (1 if m == 3 else 2)
                for q in range(3):
                    for l in range(3):
                        s[i, m] += F[i, r, q] * B[max(q, l), min(q, l)] * F[i, k, l]
                if m < 3:
                    s[i, m] += pressure - shear
        if len(c) > 0:
            add_identity(c, i, k1, k4)


@kernel
def add_mooney_rivlin(F, J, gen, count, w, par, intact, rest, s, c):
    """Add distortional stress and tangent of Mooney-Rivlin bonds, ``par`` (1|n, 2) c1 and c2; as
    :func:`add_neo_hookean`. Tensions of all generations are summed before their deviator is taken: J_(g-1) w_g / J."""
    b, b2, T, h = np.empty(6), np.empty(6), np.empty(6), np.empty((1, 6, 6))
    G, Ui = np.empty((1, 3, 3)), np.empty((3, 3))
    for i in range(len(J)):
        m = i if len(par) > 1 else 0
        c1, c2 = par[m, 0], par[m, 1]
        clear(T, h)
        for g in range(w.shape[1]):
            k = w[i, g]
            if k == 0.0:
                continue
            if 0 < g < count[i]:
                inverse_of(gen[i, g - 1, 5:11], Ui)
                product(F[i], Ui, G[0])
                left_cauchy_green(G, 0, (J[i] / gen[i, g - 1, 1]) ** (-2.0 / 3.0), b)
            else:
                left_cauchy_green(F, i, J[i] ** (-2.0 / 3.0), b)
            square(b, b2)
            first, second = 2.0 * k * (c1 + trace(b) * c2), 2.0 * k * c2
            for p in range(6):
                T[p] += first * b[p] - second * b2[p]
            if len(c) > 0 and c2 != 0.0:
                add_dyad(h, 0, 2.0 * second, b)
                add_circle(h, 0, -2.0 * second, b)
        if not rest:
            add_deviatoric_stress(s, i, intact[i] / J[i], T)
        if len(c) > 0:
            add_deviatoric_tangent(c, i, intact[i] / J[i], T, h)


@kernel
def born_along(a, gen, count, used, iso, A):
    """Fibers A (n, b, 3) that F stretches as a generation of ``used`` is stretched along ``a`` (1|n, 3), which it has
    been since its birth: U^-1 a, or J^1/3 U^-1 a where ``iso``, (U, J) the state in which it was born."""
    Ui = np.empty((3, 3))
    for i in range(A.shape[0]):
        d = i if len(a) > 1 else 0
        for k in range(len(used)):
            g = used[k]
            if g == 0 or g >= count[i]:
                for r in range(3):
                    A[i, k, r] = a[d, r]
                continue
            inverse_of(gen[i, g - 1, 5:11], Ui)
            scale = gen[i, g - 1, 1] ** (1.0 / 3.0) if iso else 1.0
            for r in range(3):
                A[i, k, r] = scale * (Ui[r, 0] * a[d, 0] + Ui[r, 1] * a[d, 1] + Ui[r, 2] * a[d, 2])


@kernel
def add_bonds(w, s, c, S, C):
    """S (n, 6) += sum_g w_g s_g and C (n, 6, 6) += sum_g w_g c_g, w (n, g), s (n g, 6), c (n g, 6, 6)."""
    b = w.shape[1]
    for i in range(w.shape[0]):
        for g in range(b):
            k = w[i, g]
            if k == 0.0:
                continue
            for p in range(6):
                if len(S) > 0:
                    S[i, p] += k * s[i * b + g, p]
                if len(C) > 0:
                    for q in range(6):
                        C[i, p, q] += k * c[i * b + g, p, q]


@kernel
def since_birth(F, J, gen, count, used, at_J, at_U, Fg, Jg, Jb):
    """F U^-1 and J / Jb of point i for each of the b generations ``used``: Fg (n b, 3, 3), Jg (n b,), Jb (n, b).

    Generation g was born in the state (U, Jb) kept with generation g - 1 in ``gen`` (n, capacity, columns), U
    symmetric in the columns from ``at_U`` (xx yy zz xy yz xz); the first, and those beyond ``count``, in the
    reference state.
    """
    b = len(used)
    for i in range(len(J)):
        f = F[i]
        for k in range(b):
            g, m = used[k], i * b + k
            if g == 0 or g >= count[i]:
                Jb[i, k] = 1.0
                Jg[m] = J[i]
                for r in range(3):
                    for c in range(3):
                        Fg[m, r, c] = f[r, c]
                continue
            q = gen[i, g - 1]
            x, y, z, xy, yz, xz = (
                q[at_U], q[at_U + 1], q[at_U + 2], q[at_U + 3], q[at_U + 4], q[at_U + 5]
            )  # fmt: skip
            c0, c1, c2 = y * z - yz * yz, xz * yz - xy * z, xy * yz - xz * y
            d = 1.0 / (x * c0 + xy * c1 + xz * c2)
            i00, i01, i02 = c0 * d, c1 * d, c2 * d
            i11, i12, i22 = (x * z - xz * xz) * d, (xy * xz - x * yz) * d, (x * y - xy * xy) * d
            for r in range(3):
                u, v, w = f[r, 0], f[r, 1], f[r, 2]
                Fg[m, r, 0] = u * i00 + v * i01 + w * i02
                Fg[m, r, 1] = u * i01 + v * i11 + w * i12
                Fg[m, r, 2] = u * i02 + v * i12 + w * i22
            Jb[i, k] = q[at_J]
            Jg[m] = J[i] / q[at_J]
