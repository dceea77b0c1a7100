"""Electroneutrality and partition coefficients at points (formulas: :mod:`..multiphasic.partition`)."""

from __future__ import annotations

import math

from ..jit import kernel

MOST, LONGEST, SETTLED = 100, 2.0, 1e-13  # steps of Newton's method, the longest, the last


@kernel
def potential(z, kc, cF, y):
    """y (n,) = ln zeta of sum_i z_i kc_i zeta^z_i + cF = 0, for charge numbers z (m,), kc (n, m), cF (n,).

    0 where ions of the sign that the fixed charge asks for are missing; Newton's method starts from y.
    """
    monovalent = True
    for k in range(len(z)):
        monovalent = monovalent and abs(z[k]) <= 1.0
    for i in range(len(y)):
        cations = anions = 0.0
        for k in range(len(z)):
            if z[k] > 0.0:
                cations += kc[i, k]
            elif z[k] < 0.0:
                anions += kc[i, k]
        y[i] = _monovalent(cations, anions, cF[i]) if monovalent else _general(z, kc[i], cF[i], y[i])


@kernel
def _monovalent(cations, anions, cF):
    """The positive root of cations zeta^2 + cF zeta - anions = 0, without cancellation."""
    root = math.sqrt(cF * cF + 4.0 * cations * anions)
    over = 2.0 * anions if cF > 0.0 else root - cF
    under = cF + root if cF > 0.0 else 2.0 * cations
    return math.log(over / under) if over > 0.0 and under > 0.0 else 0.0


@kernel
def _general(z, kc, cF, guess):
    """Newton's method for y = ln zeta, with steps of bounded length."""
    plus, minus = cF > 0.0, cF < 0.0
    for k in range(len(z)):
        plus = plus or (z[k] > 0.0 and kc[k] != 0.0)
        minus = minus or (z[k] < 0.0 and kc[k] != 0.0)
    if not (plus and minus):
        return 0.0
    y = guess if math.isfinite(guess) else 0.0
    for _ in range(MOST):
        total, slope = cF, 0.0
        for k in range(len(z)):
            term = z[k] * kc[k] * math.exp(z[k] * y)
            total += term
            slope += z[k] * term
        step = max(-LONGEST, min(LONGEST, -total / (slope if slope > 0.0 else 1.0)))
        y += step
        if abs(step) < SETTLED:
            break
    return y


@kernel
def slopes(z, free, c, cF, kappa, zz, dkJ, dkc, by_J, by_c, S, dkdJ, dkdc):
    """Derivatives of ln zeta by J (n,) and c (n, m) with S (n,), and those of kappa (n, m): dkdJ, dkdc.

    free (n,) = J - phi0; zz (n, m) zeta^z; dkJ (n, m), dkc (n, m, m) slopes of the solubilities, dkc without rows where
    all are 0.
    """
    m, varies = len(z), dkc.shape[0] > 0
    for i in range(len(free)):
        total, by = 0.0, cF[i] / free[i]
        for k in range(m):
            total += z[k] * z[k] * c[i, k] * kappa[i, k]
            by -= z[k] * c[i, k] * zz[i, k] * dkJ[i, k]
        S[i] = 1.0 / total if total > 0.0 else 0.0
        by_J[i] = by * S[i]
        for n in range(m):
            by = z[n] * kappa[i, n]
            if varies:
                for k in range(m):
                    by += z[k] * c[i, k] * zz[i, k] * dkc[i, k, n]
            by_c[i, n] = -by * S[i]
        for k in range(m):
            dkdJ[i, k] = zz[i, k] * dkJ[i, k] + z[k] * kappa[i, k] * by_J[i]
            for n in range(m):
                dkdc[i, k, n] = z[k] * kappa[i, k] * by_c[i, n] + (zz[i, k] * dkc[i, k, n] if varies else 0.0)
