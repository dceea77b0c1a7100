"""Tangents by differences of the stress, for laws whose derivative FEBio also takes so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..kernels.push import congruence
from ..points import Points
from .base import Floats

_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


def _push(D: Floats, pts: Points) -> Floats:
    """dS/dE (n, 6, 6) pushed forward to c, in place."""
    F, one, Ji = np.ascontiguousarray(pts.F), np.ones(pts.n), 1.0 / pts.J
    out = np.empty((pts.n, 6))
    for m in range(6):
        congruence(F, one, np.ascontiguousarray(D[:, :, m]), out)
        D[:, :, m] = out
    for m in range(6):
        congruence(F, Ji, np.ascontiguousarray(D[:, m, :]), out)
        D[:, m, :] = out
    return D


def central_tangent(stress: Callable[[Points], Floats], pts: Points, eps: float = 2e-4) -> Floats:
    """c (n, 6, 6) of a smooth law by fourth-order central differences of S along F' = (I + e) F."""
    n = pts.n
    D = np.zeros((n, 6, 6))
    eye = np.eye(3)

    def kirchhoff(G: Floats) -> Floats:
        J = np.linalg.det(G) * pts.J
        F = np.ascontiguousarray(G @ pts.F)
        tau = J[:, None] * stress(replace(pts, F=F, J=J, new=None))
        back = np.empty_like(tau)
        congruence(np.ascontiguousarray(np.linalg.inv(G)), np.ones(n), tau, back)
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

    ``stress(pts)`` returns the Cauchy stress (n, 6); it sees points turned back by the rotation R of F = R U,
    without ``new``, and must be frame indifferent.
    """
    C = np.swapaxes(pts.F, 1, 2) @ pts.F

    def piola(C: Floats) -> Floats:
        w, V = np.linalg.eigh(C)
        U = (V * np.sqrt(w)[:, None, :]) @ np.swapaxes(V, 1, 2)
        Ui = (V / np.sqrt(w)[:, None, :]) @ np.swapaxes(V, 1, 2)
        J = np.sqrt(w.prod(1))
        s = stress(replace(pts, F=np.ascontiguousarray(U), J=J, new=None))
        S = np.empty_like(s)
        congruence(np.ascontiguousarray(Ui), J, s, S)
        return S

    S0 = piola(C)
    D = np.empty((pts.n, 6, 6))
    for m, (k, l) in enumerate(_PAIRS):
        dC = np.zeros((3, 3))
        dC[k, l] += eps
        dC[l, k] += eps
        D[:, :, m] = (piola(C + dC) - S0) / eps
    return _push(D, pts)
