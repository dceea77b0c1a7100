"""Symmetric tensors over a batch of points: Voigt vectors, matrices, stretches and strains."""

from __future__ import annotations

import numpy as np

from ..matrices import eigh, eigvalsh
from .base import Floats

_AT = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
_ROW, _COLUMN = np.array([0, 1, 2, 0, 1, 0]), np.array([0, 1, 2, 1, 2, 2])


def matrix(s: Floats) -> Floats:
    """(..., 6) -> (..., 3, 3)."""
    return s[..., _AT]


def vector(m: Floats) -> Floats:
    """(..., 3, 3) -> (..., 6)."""
    return m[..., _ROW, _COLUMN]


def spectral(m: Floats, f: np.ufunc) -> Floats:
    """f of symmetric matrices (..., 3, 3) through their eigenvalues."""
    w, V = eigh(m)
    return (V * f(w)[..., None, :]) @ np.swapaxes(V, -1, -2)


def right_stretch(F: Floats) -> Floats:
    """U = (F^T F)^1/2."""
    return spectral(np.swapaxes(F, -1, -2) @ F, np.sqrt)


def distortion(F: Floats) -> Floats:
    """K2 = |dev ln V| (n,)."""
    w = eigvalsh(F @ np.swapaxes(F, -1, -2))
    h = 0.5 * np.log(np.maximum(w, 1e-300))
    return np.sqrt(((h - h.mean(-1, keepdims=True)) ** 2).sum(-1))


def strain(F: Floats) -> Floats:
    """E = (F^T F - I) / 2."""
    return 0.5 * (np.swapaxes(F, -1, -2) @ F - np.eye(3))


def norm(m: Floats) -> Floats:
    """(m : m)^1/2 of matrices (..., 3, 3)."""
    return np.sqrt((m**2).sum((-1, -2)))


def deviator(m: Floats) -> Floats:
    """m - tr m / 3 I."""
    return m - np.trace(m, axis1=-2, axis2=-1)[..., None, None] / 3.0 * np.eye(3)
