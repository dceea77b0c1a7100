"""Inner products and norms of long vectors on one thread: BLAS would wake its own threads for each."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from .kernels.vectors import inner


def dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """a . b"""
    return inner(a, b)


def norm(a: NDArray[np.float64]) -> float:
    """|a|"""
    return sqrt(inner(a, a))
