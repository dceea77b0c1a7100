"""Special functions over arrays of any shape; see :mod:`.kernels.special`."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .kernels import special

Floats = NDArray[np.float64]


def _apply(kernel: Callable[..., Any], *args: ArrayLike, flags: tuple[bool, ...] = ()) -> Floats:
    whole = np.broadcast_arrays(*(np.asarray(a, float) for a in args))
    out = np.empty(whole[0].shape)
    kernel(*(np.ascontiguousarray(a).reshape(-1) for a in whole), *flags, out.reshape(-1))
    return out


def erfc(x: ArrayLike) -> Floats:
    """1 - erf x."""
    return _apply(special.erfc, x)


def gamma(x: ArrayLike) -> Floats:
    """Gamma function (of parameters, few numbers: numba's needs numba to run)."""
    values = np.asarray(x, float)
    return np.array([math.gamma(v) for v in values.ravel().tolist()]).reshape(values.shape)


def gammainc(a: ArrayLike, x: ArrayLike) -> Floats:
    """Regularised lower incomplete gamma function P(a, x)."""
    return _apply(special.gammainc, a, x, flags=(False,))


def gammaincc(a: ArrayLike, x: ArrayLike) -> Floats:
    """Regularised upper incomplete gamma function Q(a, x) = 1 - P(a, x)."""
    return _apply(special.gammainc, a, x, flags=(True,))


def expi(x: ArrayLike) -> Floats:
    """Exponential integral Ei(x)."""
    return _apply(special.expi, x)


def k1(x: ArrayLike) -> Floats:
    """Modified Bessel function of the second kind K1(x)."""
    return _apply(special.k1, x)
