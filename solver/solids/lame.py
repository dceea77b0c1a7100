"""Lame's coefficients from Young's modulus and Poisson's ratio."""

from __future__ import annotations

from ..jit import kernel
from .base import Floats


@kernel
def lame(E, v):
    """lambda = E v / ((1 + v)(1 - 2v)), mu = E / (2 (1 + v))."""
    return v * E / ((1.0 + v) * (1.0 - 2.0 * v)), 0.5 * E / (1.0 + v)


def shear_and_first(par: Floats) -> tuple[Floats, Floats]:
    """lambda and mu of the first two columns (E, v) of parameters."""
    E, v = par[:, 0], par[:, 1]
    return v * E / ((1.0 + v) * (1.0 - 2.0 * v)), 0.5 * E / (1.0 + v)
