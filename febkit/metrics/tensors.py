"""Second-order tensors stored component by component: (3, 3, ...) and symmetric (6, ...) xx yy zz xy yz xz.

Components first keeps each one contiguous, so every operation below is a few sweeps over long arrays.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


def multiply(a: Floats, b: Floats) -> Floats:
    """(3, 3, ...) product a.b."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j]
            out[i, j] += a[i, 1] * b[1, j]
            out[i, j] += a[i, 2] * b[2, j]
    return out


def determinant(a: Floats) -> Floats:
    """(...) determinant of (3, 3, ...)."""
    return np.asarray(
        a[0, 0] * (a[1, 1] * a[2, 2] - a[1, 2] * a[2, 1])
        + a[0, 1] * (a[1, 2] * a[2, 0] - a[1, 0] * a[2, 2])
        + a[0, 2] * (a[1, 0] * a[2, 1] - a[1, 1] * a[2, 0])
    )


def inverse(a: Floats, det: Floats | None = None) -> Floats:
    """(3, 3, ...) inverse by cofactors."""
    out = np.empty(a.shape)
    for i in range(3):
        for j in range(3):
            p, q, r, s = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
            out[j, i] = a[p, r] * a[q, s] - a[p, s] * a[q, r]
    out /= determinant(a) if det is None else det
    return out


def green_lagrange(F: Floats) -> Floats:
    """(6, ...) Green-Lagrange strain (F^T F - 1)/2 of F (3, 3, ...)."""
    out = np.empty((6, *F.shape[2:]))
    for k, (i, j) in enumerate(VOIGT):
        out[k] = 0.5 * (F[0, i] * F[0, j] + F[1, i] * F[1, j] + F[2, i] * F[2, j])
    out[:3] -= 0.5
    return out


def left_cauchy_green(F: Floats) -> Floats:
    """(6, ...) b = F F^T."""
    out = np.empty((6, *F.shape[2:]))
    for k, (i, j) in enumerate(VOIGT):
        out[k] = F[i, 0] * F[j, 0] + F[i, 1] * F[j, 1] + F[i, 2] * F[j, 2]
    return out


def _deviator(s: Floats) -> tuple[Floats, Floats]:
    """Mean (...) and J2 (...) = dev:dev/2 of a symmetric tensor (6, ...)."""
    mean = (s[0] + s[1] + s[2]) / 3
    J2 = (
        ((s[0] - s[1]) ** 2 + (s[1] - s[2]) ** 2 + (s[2] - s[0]) ** 2) / 6 + s[3] ** 2 + s[4] ** 2 + s[5] ** 2
    )
    return mean, J2


def effective(s: Floats) -> Floats:
    """sqrt(((l1-l2)^2 + (l2-l3)^2 + (l3-l1)^2)/2) of a symmetric tensor (6, ...); equals sqrt(3 J2)."""
    return np.asarray(np.sqrt(3 * _deviator(s)[1]))


def _lode(s: Floats, mean: Floats, J2: Floats) -> Floats:
    """Angle phi in [0, pi/3] with l_k = mean + 2 sqrt(J2/3) cos(phi - 2 pi k/3)."""
    a, b, c = s[0] - mean, s[1] - mean, s[2] - mean
    J3 = a * b * c + 2 * s[3] * s[4] * s[5] - a * s[4] ** 2 - b * s[5] ** 2 - c * s[3] ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        x = 1.5 * np.sqrt(3.0) * J3 / J2**1.5
    return np.asarray(np.arccos(np.clip(np.where(np.isnan(x), 1.0, x), -1, 1)) / 3)


def principal(s: Floats) -> Floats:
    """(3, ...) eigenvalues, largest first, of a symmetric tensor (6, ...)."""
    mean, J2 = _deviator(s)
    phi, r = _lode(s, mean, J2), 2 * np.sqrt(J2 / 3)
    first = mean + r * np.cos(phi)
    last = mean + r * np.cos(phi + 2 * np.pi / 3)
    return np.stack([first, 3 * mean - first - last, last])


def max_difference(s: Floats) -> Floats:
    """max |l_i - l_j| of a symmetric tensor (6, ...): 2 sqrt(J2) sin(phi + pi/3)."""
    mean, J2 = _deviator(s)
    return np.asarray(2 * np.sqrt(J2) * np.sin(_lode(s, mean, J2) + np.pi / 3))


def full(s: Floats) -> Floats:
    """(..., 3, 3) matrix of (6, ...)."""
    out = np.empty((*s.shape[1:], 3, 3))
    for k, (i, j) in enumerate(VOIGT):
        out[..., i, j] = out[..., j, i] = s[k]
    return out
