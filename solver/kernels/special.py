"""Special functions of distributions, elementwise over flat arrays.

Loading scipy's takes a third of a second, several times what a small model takes to solve.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import kernel

EPS = 1e-16
TINY = 1e-300
MOST = 10000  # terms


@kernel
def erfc(x, out):
    """Complementary error function."""
    for i in range(len(x)):
        out[i] = math.erfc(x[i])


@kernel
def _series(a, x):
    """Regularised lower incomplete gamma function by its series, for x < a + 1 (Abramowitz & Stegun 6.5.29)."""
    term = total = 1.0 / a
    n = a
    for _ in range(MOST):
        n += 1.0
        term *= x / n
        total += term
        if abs(term) < EPS * abs(total):
            break
    return total * math.exp(a * math.log(x) - x - math.lgamma(a))


@kernel
def _fraction(a, x):
    """Continued fraction whose product with exp(-x) x^a is the upper incomplete gamma function.

    Abramowitz & Stegun 6.5.31, evaluated forwards (Lentz, Appl. Opt. 15 (1976) 668).
    """
    b = x + 1.0 - a
    c, d = 1.0 / TINY, 1.0 / b
    h = d
    for k in range(1, MOST):
        q = -k * (k - a)
        b += 2.0
        d = q * d + b
        if abs(d) < TINY:
            d = TINY
        c = b + q / c
        if abs(c) < TINY:
            c = TINY
        d = 1.0 / d
        h *= d * c
        if abs(d * c - 1.0) < EPS:
            break
    return h


@kernel
def gammainc(a, x, upper, out):
    """Regularised incomplete gamma function P(a, x), a > 0, x >= 0; ``upper``: Q = 1 - P."""
    for i in range(len(x)):
        if not (x[i] > 0.0 and a[i] > 0.0):
            p = 0.0 if x[i] == 0.0 else np.nan
            out[i] = 1.0 - p if upper else p
        elif math.isinf(x[i]):
            out[i] = 0.0 if upper else 1.0
        elif x[i] < a[i] + 1.0:
            p = _series(a[i], x[i])
            out[i] = 1.0 - p if upper else p
        else:
            scale = math.exp(a[i] * math.log(x[i]) - x[i] - math.lgamma(a[i]))
            q = scale * _fraction(a[i], x[i])
            out[i] = q if upper else 1.0 - q


@kernel
def _exponential_fraction(x):
    """exp(x) E1(x) by its continued fraction, x >= 1 (Abramowitz & Stegun 5.1.22, forwards)."""
    b = x + 1.0
    c, d = 1.0 / TINY, 1.0 / b
    h = d
    for k in range(1, MOST):
        b += 2.0
        d = 1.0 / (b - k * k * d)
        c = b - k * k / c
        h *= c * d
        if abs(c * d - 1.0) < EPS:
            break
    return h


@kernel
def expi(x, out):
    """Exponential integral Ei(x), the principal value for x > 0 (Abramowitz & Stegun 5.1.10, 5.1.51)."""
    for i in range(len(x)):
        v = x[i]
        if v == 0.0:
            out[i] = -np.inf
        elif v < -1.0:
            out[i] = -math.exp(v) * _exponential_fraction(-v) if v > -745.0 else 0.0
        elif v < 40.0:
            term, total = 1.0, 0.0
            for k in range(1, MOST):
                term *= v / k
                total += term / k
                if abs(term / k) < 0.1 * EPS * abs(total):
                    break
            out[i] = 0.57721566490153286061 + math.log(abs(v)) + total
        elif v < 716.0:
            term = total = 1.0
            for k in range(1, 60):  # asymptotic: its terms fall up to k = v
                term *= k / v
                total += term
                if term < EPS or k >= v:
                    break
            out[i] = math.exp(v) / v * total
        else:
            out[i] = np.inf


@kernel
def k1(x, out):
    """Modified Bessel function K1(x), x > 0: its series (Abramowitz & Stegun 9.6.11) or the integral (9.6.24).

    The integrand exp(-x cosh t) cosh t falls so fast at both ends that the trapezoidal rule is exact to rounding.
    """
    for i in range(len(x)):
        v = x[i]
        if not v > 0.0:
            out[i] = np.inf if v == 0.0 else np.nan
        elif v <= 2.0:
            q = 0.25 * v * v
            term, psi = 1.0, 1.0 - 2.0 * 0.57721566490153286061  # psi(k + 1) + psi(k + 2)
            first, second = 1.0, psi
            for k in range(1, 40):
                term *= q / (k * (k + 1.0))
                psi += 1.0 / k + 1.0 / (k + 1.0)
                first += term
                second += term * psi
                if term < EPS:
                    break
            out[i] = 1.0 / v + 0.5 * v * (math.log(0.5 * v) * first - 0.5 * second)
        else:
            h, total = min(0.2, 0.5 / math.sqrt(v)), 0.5
            for k in range(1, MOST):
                c = 2.0 * math.sinh(0.5 * k * h) ** 2  # cosh - 1
                term = math.exp(-v * c) * (c + 1.0)
                total += term
                if term < EPS * total:
                    break
            out[i] = h * math.exp(-v) * total
