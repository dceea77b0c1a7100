"""GMRES with an older factorisation as preconditioner (Saad and Schultz, SIAM J Sci Stat Comput 7, 1986)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..kernels.sparse import multiply
from ..vectors import dot
from .base import Floats, Matrix


def matvec(A: Matrix, x: Floats) -> Floats:
    """A x, with the lower triangle implied where only the upper one is stored."""
    y = np.zeros_like(x)
    multiply(A.indptr, A.indices, A.data, A.symmetric, x, y)
    return y


def gmres(
    A: Matrix, b: Floats, precondition: Callable[[Floats], Floats], tolerance: float, most: int
) -> tuple[Floats, Floats, float]:
    """Solve A x = b from the left-preconditioned system M^-1 A x = M^-1 b.

    Returns x, M^-1 b and the preconditioned residual relative to M^-1 b. No restart: ``most`` bounds memory and
    work, and a result that has not reached ``tolerance`` is returned as it is. Where M^-1 b itself leaves less
    than a tenth of ``tolerance`` of b (a fresh factorisation), it is the answer.
    """
    r = precondition(b)
    beta = np.sqrt(dot(r, r))
    if beta == 0.0:
        return np.zeros_like(b), r, 0.0
    left = b - matvec(A, r)
    if dot(left, left) < (0.1 * tolerance) ** 2 * dot(b, b):
        return r, r, 0.1 * tolerance
    V = [r / beta]
    H = np.zeros((most + 1, most))
    best, error = np.zeros(0), 1.0
    for k in range(most):
        w = precondition(matvec(A, V[k])) if k else (r - precondition(left)) / beta
        for i in range(k + 1):
            H[i, k] = dot(V[i], w)
            w -= H[i, k] * V[i]
        H[k + 1, k] = np.sqrt(dot(w, w))
        e = np.zeros(k + 2)
        e[0] = beta
        best = np.asarray(np.linalg.lstsq(H[: k + 2, : k + 1], e, rcond=None)[0], dtype=float)
        error = float(np.linalg.norm(e - H[: k + 2, : k + 1] @ best)) / beta
        if error < tolerance or H[k + 1, k] == 0.0:
            break
        V.append(w / H[k + 1, k])
    x = np.zeros_like(b)
    for v, c in zip(V, best):
        x += c * v
    return x, r, error
