"""Full tensors from Voigt's columns xx yy zz xy yz xz."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
_NINE = [0, 3, 5, 3, 1, 4, 5, 4, 2]


def full(v: Floats) -> Floats:
    """Symmetric tensors (..., 3, 3) of Voigt columns (..., 6)."""
    return v[..., _NINE].reshape(*v.shape[:-1], 3, 3)


def full4(d: Floats) -> Floats:
    """Tensors of minor symmetry (..., 3, 3, 3, 3) of matrices (..., 6, 6)."""
    return d[..., _NINE, :][..., _NINE].reshape(*d.shape[:-2], 3, 3, 3, 3)
