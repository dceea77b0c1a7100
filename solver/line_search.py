"""How far to go along a direction: FEBio's line search on the work of the residual along it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .group import NegativeJacobian
from .problem import NewtonOptions
from .vectors import dot

Floats = NDArray[np.float64]
Move = Callable[[Floats], None]


def search(u: Floats, R0: Floats, move: Move, residual: Callable[[], Floats], o: NewtonOptions) -> tuple[float, Floats]:
    """Step length s with |u . R(s)| < lstol |u . R(0)| (a cubic of the energy), and R there.

    ``move`` takes the state to an increment, ``residual`` gives R there.
    """
    if o.line_tolerance <= 0:
        move(u)
        return 1.0, residual()
    s = best = 1.0
    r0 = dot(u, R0)
    least = abs(r0)
    n = 0
    while True:
        s = _try(u, s, move, o)
        R1 = residual()
        if s < o.line_minimum and not o.line_check_jacobians:
            move(0.5 * u)
            return 0.5, residual()
        r1 = dot(u, R1)
        if n == 0 or abs(r1) < least:
            best, least = s, abs(r1)
        r = 0.0 if abs(r1) < 1e-17 else abs(r1 / r0) if r0 else np.inf
        if not r > o.line_tolerance:
            return s, R1
        s = _next(s, r0 / r1)
        n += 1
        if n >= o.line_iterations:
            move(best * u)
            return best, residual()


def _next(s: float, a: float) -> float:
    A = 1 + a * (s - 1)
    B = a * s * s
    D = B * B - 4 * A * B
    if A == 0:
        return 0.0
    if D < 0:
        return 0.5 * B / A
    root = np.sqrt(D)
    s = (B + root) / (2 * A)
    if s < 0:
        s = (B - root) / (2 * A)
    return max(s, 0.0)


def _try(u: Floats, s: float, move: Move, o: NewtonOptions) -> float:
    """Move to s u; where elements turn inside out and Jacobians are checked, half as far."""
    if not o.line_check_jacobians:
        move(s * u)
        return s
    for n in range(o.line_iterations + 2):
        try:
            move(s * u)
            return s
        except NegativeJacobian:
            if n > o.line_iterations:
                raise
            s *= 0.5
    return s
