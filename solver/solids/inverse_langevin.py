"""Series of the inverse Langevin function, as FEBio has it."""

from __future__ import annotations

import numpy as np

from .base import Floats

#: beta = sum_k COEFFICIENTS[k] x^(2k+1); the last of FEBio's thirty numbers are not those of the series
COEFFICIENTS = (
    3.0, 1.8, 1.697142857142857, 1.758857142857143,
    1.8719219865524765, 1.9972456800342515, 2.1128236517767944, 2.2023028715016078,
    2.2529578706640487, 2.2557674927967937, 2.2064006684261215, 2.10642783876864,
    1.9643613379981597, 1.7961853288408385, 1.6250621936173801, 1.479948306283816,
    1.3929414196781063, 1.395325732121284, 1.5124802847349257, 1.7580618778208568,
    2.128142773840306, 2.596240340751755, 3.110372438873185, 3.5933518939552567,
    3.947436540863911, 4.064125821316466, 3.8393076651952027, 3.193110061275431,
    2.092746228934893, 0.5754634138721401,
)


def even_series(x2: Floats, terms: int) -> tuple[Floats, Floats]:
    """beta / x and its derivative by x^2, from x^2, with so many terms."""
    c = np.array(COEFFICIENTS[: min(int(terms), len(COEFFICIENTS))])
    value = np.polynomial.polynomial.polyval(x2, c)
    slope = np.polynomial.polynomial.polyval(x2, c[1:] * np.arange(1, len(c)))
    return np.asarray(value), np.asarray(slope)  # type: ignore[return-value]
