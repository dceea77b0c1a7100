"""Tangents by differences of the stress, for laws whose derivative FEBio also takes so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..kernels.push import congruence
from ..matrices import det, eigh, inv
from ..points import Points
from .base import Floats
from .batches import states

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

    ``stress(pts)`` returns the Cauchy stress (n, 6); it sees points turned back by the rotation R of F = R U,
    with ``old`` and without ``new``, and must be frame indifferent.
    """
    C = (np.swapaxes(pts.F, 1, 2) @ pts.F)[:, None] + np.zeros((7, 1, 1))
    for m, (k, l) in enumerate(_PAIRS):
        C[:, m + 1, k, l] += eps
        C[:, m + 1, l, k] += eps
    w, V = eigh(C)
    root = np.sqrt(w)
    U = (V * root[..., None, :]) @ np.swapaxes(V, -1, -2)
    Ui = (V / root[..., None, :]) @ np.swapaxes(V, -1, -2)
    turned = states(pts, U, root.prod(-1), history=True)
    s = stress(turned)
    S = np.empty_like(s)
    congruence(np.ascontiguousarray(Ui.reshape(-1, 3, 3)), turned.J, s, S)
    S = S.reshape(pts.n, 7, 6)
    D = (S[:, 1:] - S[:, :1]) / eps  # (n, pair, 6)
    return _push(np.ascontiguousarray(np.swapaxes(D, 1, 2)), pts)
