"""Residuals by their logarithm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
LEAST = 1e-8  # forces that have a logarithm, as in FEBio


def logarithmic(internal: Floats, external: Floats) -> Floats:
    """The residual R = F + r of internal forces r and loads F by Fi log(F / Fi), Fi = -r, where both push to one side.

    It is zero where R is, and less curved for materials that stiffen exponentially (Mei, Hurtado, Pant, Aggarwal, "On
    improving the numerical convergence of highly nonlinear elasticity problems", Comput Methods Appl Mech Eng 337
    (2018) 110).
    """
    some = (np.abs(external) > LEAST) & (np.abs(internal) > LEAST) & (external * internal < 0.0)
    out = internal + external
    out[some] = -internal[some] * np.log(-external[some] / internal[some])
    return out
