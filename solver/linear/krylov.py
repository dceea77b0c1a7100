"""GMRES with an older factorisation as preconditioner (Saad and Schultz, SIAM J Sci Stat Comput 7, 1986), its flexible
variant preconditioned from the right (Saad, SIAM J Sci Comput 14, 1993), and one whose directions serve several
right-hand sides."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from ..kernels.sparse import multiply
from ..vectors import dot, norm
from .base import Floats, Matrix

Ints = NDArray[np.int64]


def matvec(A: Matrix, x: Floats) -> Floats:
    """A x, with the lower triangle implied where only the upper one is stored."""
    y = np.zeros_like(x)
    multiply(A.indptr, A.indices, A.data, A.symmetric, x, y)
    return y


def gmres(
    A: Matrix, b: Floats, precondition: Callable[[Floats], Floats], tolerance: float, most: int,
    fields: Sequence[Ints] = (),
) -> tuple[Floats, Floats, float]:  # fmt: skip
    """Solve A x = b from the left-preconditioned system M^-1 A x = M^-1 b.

    Returns x, M^-1 b and the preconditioned residual relative to M^-1 b, in which ``fields`` count as in
    :class:`Recycled`. No restart: ``most`` bounds memory and work, and a result that has not reached ``tolerance`` is
    returned as it is. Where M^-1 b itself leaves less than a tenth of ``tolerance`` of b (a fresh factorisation), it is
    the answer, as it is where numbers are too large for their squares.
    """
    z = precondition(b)
    scale = weights(z, fields) if len(fields) > 1 else np.ones(1)
    r = scale * z
    beta = norm(r)
    if beta == 0.0:
        return np.zeros_like(b), z, 0.0
    if not np.isfinite(beta):
        return z, z, np.inf
    left = b - matvec(A, z)
    if dot(left, left) < (0.1 * tolerance) ** 2 * dot(b, b):
        return z, z, 0.1 * tolerance
    V = [r / beta]
    H = np.zeros((most + 1, most))
    best, error = np.zeros(0), beta
    for k in range(most):
        w = scale * precondition(matvec(A, V[k] / scale)) if k else (r - scale * precondition(left)) / beta
        if not np.isfinite(dot(w, w)):
            break
        best, error = _extend(V, H, w, k, beta)
        if error < tolerance * beta or H[k + 1, k] == 0.0:
            break
        V.append(w / H[k + 1, k])
    if not len(best):
        return z, z, np.inf
    x = np.zeros_like(b)
    for v, c in zip(V, best):
        x += c * v
    return x / scale, z, error / beta


def _extend(V: list[Floats], H: Floats, w: Floats, k: int, beta: float) -> tuple[Floats, float]:
    """Make w orthogonal to V and enter it as column k of H; least-squares coefficients, and the residual they leave."""
    for i in range(k + 1):
        H[i, k] = dot(V[i], w)
        w -= H[i, k] * V[i]
    H[k + 1, k] = np.sqrt(dot(w, w))
    e = np.zeros(k + 2)
    e[0] = beta
    best = np.asarray(np.linalg.lstsq(H[: k + 2, : k + 1], e, rcond=None)[0], dtype=float)
    return best, float(np.linalg.norm(e - H[: k + 2, : k + 1] @ best))


class Recycled:
    """Systems A x = b of one matrix, preconditioned from the left by M, that learn from each other.

    Generalised conjugate residuals (Eisenstat, Elman and Schultz, SIAM J Numer Anal 20, 1983): for each direction p
    there is q = M^-1 A p, all q orthonormal, so that x = sum (q . r) p leaves the least M^-1 (b - A x) of all x that
    the directions can make. Earlier systems' come first, at an inner product each; a new one costs a product with
    A and a solve with M. ``keep`` bounds memory: the oldest go. ``fields``: the unknowns of each field, all of which
    count as the first M^-1 b has made them; none: each unknown counts as it is.
    """

    def __init__(
        self, A: Matrix, precondition: Callable[[Floats], Floats], keep: int = 30, fields: Sequence[Ints] = ()
    ) -> None:  # fmt: skip
        self.A, self.precondition, self.keep, self.fields = A, precondition, keep, fields
        self._scale: Floats | None = None  # of each unknown
        self._pairs: list[tuple[Floats, Floats]] = []
        self.solves = 0  # with M

    def solve(self, b: Floats, tolerance: float, most: int) -> tuple[Floats, float]:
        """x, and |M^-1 (b - A x)| / |M^-1 b|; it is inf where numbers are too large. ``most``: new directions."""
        x, r = np.zeros_like(b), self.precondition(b).copy()
        self.solves += 1
        if self._scale is None and len(self.fields) > 1:
            self._scale = weights(r, self.fields)
        if self._scale is not None:
            r *= self._scale
        first = error = norm(r)
        if first == 0.0:
            return x, 0.0
        if not np.isfinite(first):
            return r, np.inf
        for p, q in self._pairs:
            self._step(p, q, x, r)
        error = norm(r)
        for _ in range(most):
            if error <= tolerance * first:
                break
            pair = self._extend(r)
            if pair is None:
                return x, np.inf
            self._step(*pair, x, r)
            error = norm(r)
        return x if self._scale is None else x / self._scale, error / first

    @staticmethod
    def _step(p: Floats, q: Floats, x: Floats, r: Floats) -> None:
        c = dot(q, r)
        x += c * p
        r -= c * q

    def _extend(self, r: Floats) -> tuple[Floats, Floats] | None:
        """A direction along r; None where it leads nowhere."""
        p = r.copy()
        if self._scale is None:
            q = self.precondition(matvec(self.A, r))
        else:
            q = self._scale * self.precondition(matvec(self.A, r / self._scale))
        self.solves += 1
        for a, b in self._pairs:
            c = dot(b, q)
            p -= c * a
            q -= c * b
        size = norm(q)
        if not np.isfinite(size) or size == 0.0:
            return None
        p /= size
        q /= size
        self._pairs = [*self._pairs[1 - self.keep :], (p, q)]
        return p, q


def weights(x: Floats, fields: Sequence[Ints]) -> Floats:
    """One over the norm of each unknown's field in x; 1 where there is none."""
    w = np.ones_like(x)
    for own in fields:
        size = norm(x[own])
        if 0.0 < size < np.inf:
            w[own] = 1.0 / size
    return w


def fgmres(
    apply: Callable[[Floats], Floats], b: Floats, precondition: Callable[[Floats], Floats], tolerance: float,
    restart: int, most: int,
) -> tuple[Floats, float, int]:  # fmt: skip
    """Solve A x = b, ``apply`` being x -> A x, with a preconditioner that may change from call to call.

    Returns x, |b - A x| / |b| and the iterations used (``most`` at most); the residual is formed anew at each restart.
    """
    x, used, first = np.zeros_like(b), 0, np.sqrt(dot(b, b))
    r, beta = b, first
    while beta > tolerance * first and used < most:
        V, Z = [r / beta], []
        H, best = np.zeros((restart + 1, restart)), np.zeros(0)
        for k in range(min(restart, most - used)):
            Z.append(precondition(V[k]))
            w, used = apply(Z[k]), used + 1
            if not np.isfinite(dot(w, w)):
                break
            best, error = _extend(V, H, w, k, beta)
            if error < 0.9 * tolerance * first or H[k + 1, k] == 0.0:
                break
            V.append(w / H[k + 1, k])
        for z, c in zip(Z, best):
            x += c * z
        r = b - apply(x)
        before, beta = beta, np.sqrt(dot(r, r))
        if not beta < 0.99 * before:  # it has come to a halt
            break
    return x, float(beta / first) if first else 0.0, used
