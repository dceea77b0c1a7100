"""Shape of a cell from its volumes and second moments (study eqs 10-13)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def sums(owner: Ints, values: Floats, count: int) -> Floats:
    """(..., count) sums over the elements of each cell of ``values`` (..., e)."""
    flat = values.reshape(-1, values.shape[-1])
    out = np.stack([np.bincount(owner, row, minlength=count).astype(float) for row in flat])
    return out.reshape(*values.shape[:-1], count)


def second_moments(volume: Floats, position: Floats) -> tuple[Floats, Floats]:
    """First moments (3, e) and second moments (6, e) about the origin, xx yy zz xy yz xz.

    ``volume`` (g, e) or (e,) weights at ``position`` (3, g, e) or (3, e); summed over g.
    """
    first = volume * position
    x, y, z = position
    second = np.stack([first[0] * x, first[1] * y, first[2] * z, first[0] * y, first[1] * z, first[0] * z])
    if volume.ndim == 2:
        return first.sum(axis=1), second.sum(axis=1)
    return first, second


def central(volume: Floats, first: Floats, second: Floats) -> Floats:
    """(..., 3, 3) second-moment tensor about the centroid from sums (...), (3, ...), (6, ...)."""
    c = first / volume
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
    out = np.empty((*volume.shape, 3, 3))
    for k, (i, j) in enumerate(pairs):
        out[..., i, j] = out[..., j, i] = second[k] - volume * c[i] * c[j]
    return out


def inertia(moments: Floats) -> Floats:
    """(..., 3, 3) inertia tensor tr(S) 1 - S of the second moments S (eq 10)."""
    trace = np.trace(moments, axis1=-2, axis2=-1)
    return np.asarray(trace[..., None, None] * np.eye(3) - moments)


def printed_axes(moments: Floats) -> Floats:
    """(..., 3) axis lengths L_i = 1/sqrt(lambda_i), shortest first, of the inertia's eigenvalues (eq 11).

    These are not lengths of an ellipsoid's axes: see :func:`ellipsoid_axes`.
    """
    with np.errstate(divide="ignore", invalid="ignore"):  # one element: its centroid has no inertia
        return np.asarray(1 / np.sqrt(np.linalg.eigvalsh(inertia(moments))[..., ::-1]))


def printed_ratio(moments: Floats) -> Floats:
    """(...) L3/L1 as printed (eq 12), the root of the ratio of extreme inertias; NaN for one element."""
    L = printed_axes(moments)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.asarray(L[..., 2] / L[..., 0])
    return np.where(np.isfinite(ratio), ratio, np.nan)


def ellipsoid_axes(volume: Floats, moments: Floats) -> Floats:
    """(..., 3) semi-axes, shortest first, of the ellipsoid of the same volume-normalised inertia.

    a^2 = 5/(2 M) (lambda_b + lambda_c - lambda_a) = 5 s_a / M with s_a the principal second moments.
    """
    s = np.linalg.eigvalsh(moments)
    return np.asarray(np.sqrt(5 * np.maximum(s, 0) / volume[..., None]))
