"""Tangents by differences of the stress, for laws whose derivative FEBio also takes so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..kernels.push import congruence
from ..kernels.secant import add_differences, stretched
from ..matrices import det, inv
from ..points import Points
from .base import Floats
from .batches import states

_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


def central_tangent(stress: Callable[[Points], Floats], pts: Points, eps: float = 2e-4) -> Floats:
    """c (n, 6, 6) of a smooth law by fourth-order central differences of S along F' = (I + e) F."""
    n = pts.n
    D = np.zeros((n, 6, 6))
    eye = np.eye(3)

    def kirchhoff(G: Floats) -> Floats:
        J = det(G) * pts.J
        F = np.ascontiguousarray(G @ pts.F)
        tau = J[:, None] * stress(replace(pts, F=F, J=J, new=None))
        back = np.empty_like(tau)
        congruence(np.ascontiguousarray(inv(G)), np.ones(n), tau, back)
        return back

    for m, (k, l) in enumerate(_PAIRS):
        d = np.zeros((3, 3))
        d[k, l] += 0.5
        d[l, k] += 0.5
        w = [kirchhoff(np.broadcast_to(eye + j * eps * d, (n, 3, 3))) for j in (-2, -1, 1, 2)]
        D[:, :, m] = (w[0] - 8.0 * w[1] + 8.0 * w[2] - w[3]) / (12.0 * eps)
    return D / pts.J[:, None, None]


def secant_tangent(stress: Callable[[Points], Floats], pts: Points, eps: float = 1e-8) -> Floats:
    """c (n, 6, 6) from forward differences of S(E): dS/dE_kl pushed forward and divided by J.

    ``stress(pts)`` returns the Cauchy stress (7 n, 6); it sees each point seven times, turned back by the rotation R of
    F = R U and without a history, and must be frame indifferent.
    """
    n = pts.n
    U, Ui, J, c = np.empty((n, 7, 3, 3)), np.empty((7 * n, 3, 3)), np.empty(7 * n), np.zeros((n, 6, 6))
    stretched(pts.F, eps, U.reshape(-1, 3, 3), Ui, J)
    s = np.ascontiguousarray(stress(states(pts, U, J)))
    add_differences(s, Ui, J, pts.F, eps, np.empty_like(s), c)
    return c
