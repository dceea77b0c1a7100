"""Invariants of the right Cauchy-Green tensor over a batch of points."""

from __future__ import annotations

import numpy as np

from ..points import Points
from .base import Floats


def invariants(pts: Points) -> tuple[Floats, Floats]:
    """I1 = tr C and I2 = (I1^2 - tr C^2) / 2, each (n,)."""
    C = np.swapaxes(pts.F, 1, 2) @ pts.F
    I1 = np.trace(C, axis1=1, axis2=2)
    return I1, 0.5 * (I1**2 - (C**2).sum((1, 2)))


def isochoric_invariants(pts: Points) -> tuple[Floats, Floats]:
    """I1~ = J^-2/3 I1 and I2~ = J^-4/3 I2."""
    I1, I2 = invariants(pts)
    return I1 * pts.J ** (-2.0 / 3.0), I2 * pts.J ** (-4.0 / 3.0)
