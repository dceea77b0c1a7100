"""Dense LU for scenes so small that loading a sparse solver would cost more than solving."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernels.dense import lu, lu_solve
from .base import Floats, LinearError, Matrix

Ints = NDArray[np.int64]


def narrow(joined: NDArray[np.bool_]) -> Ints:
    """An order of the unknowns that gathers a symmetric pattern (n, n) near its diagonal.

    Level by level from an unknown at the rim, those of few neighbours first. Cuthill and McKee, Proc 24th Nat
    Conf ACM (1969); George and Liu, ACM Trans Math Softw 5 (1979) for the rim.
    """
    degree = joined.sum(axis=1)
    left, out = np.ones(len(joined), bool), []
    while left.any():
        levels: list[Ints] = []
        start = int(np.flatnonzero(left)[np.argmin(degree[left])])
        while True:
            new = _levels(joined, left, degree, start)
            if len(new) <= len(levels):
                break
            levels, start = new, int(new[-1][0])
        out += levels
        left[np.concatenate(levels)] = False
    return np.concatenate(out)


def _levels(joined: NDArray[np.bool_], left: NDArray[np.bool_], degree: Ints, start: int) -> list[Ints]:
    out, open_ = [np.array([start])], left.copy()
    open_[start] = False
    while True:
        near = np.flatnonzero(joined[out[-1]].any(axis=0) & open_)
        if not len(near):
            return out
        open_[near] = False
        out.append(near[np.argsort(degree[near], kind="stable")])


SINGULAR = "dense LU: the matrix is singular (a body or node is not held?)"
STRAY = 1e-9  # of the largest right side: what may remain of one, where a motion has no stiffness


class _Loose:
    """A singular matrix (n, n): the least x of M x = b where there is one, so motions without stiffness stay.

    Raises LinearError where b loads such a motion.
    """

    def __init__(self, M: Floats) -> None:
        if not np.isfinite(M).all():
            raise LinearError(SINGULAR)
        U, s, V = np.linalg.svd(M)
        held = s > 1e-14 * len(s) * s[0]
        self.M, self.count, self._most = M, int((~held).sum()), 0.0
        self._inverse = (V[held].T / s[held]) @ U[:, held].T

    def solve(self, b: Floats) -> Floats:
        x = self._inverse @ b
        self._most = max(self._most, float(np.linalg.norm(b)))
        if not np.linalg.norm(b - self.M @ x) <= STRAY * self._most:
            raise LinearError(SINGULAR)
        return np.asarray(x)


class Dense:
    def __init__(self) -> None:
        self.name = "dense LU"
        self.stats: dict[str, float] = {}
        self._loose: _Loose | None = None
        self._motions = 0  # without stiffness, at most so far
        self._pattern: tuple[object, object] | None = None
        self._factored = False

    def _analyse(self, A: Matrix) -> None:
        """Order the unknowns; where the entries of A go in the dense matrix."""
        n = A.n
        self._lu = np.empty((n, n))
        self._pivots, self._first, self._last = (np.empty(n, np.int64) for _ in range(3))
        self._pattern = A.indptr, A.indices
        found = A.take(Dense)
        if found is None:
            found = self._places(A)
        A.give(Dense, found)
        self._order, self._at, self._mirror = found

    @staticmethod
    def _places(A: Matrix) -> tuple[Ints, Ints, Ints | None]:
        n = A.n
        rows, columns = np.repeat(np.arange(n), np.diff(A.indptr)), A.indices.astype(np.int64)
        joined = np.zeros((n, n), bool)
        joined[rows, columns] = joined[columns, rows] = True
        order = narrow(joined)
        place = np.empty(n, np.int64)
        place[order] = np.arange(n)
        return order, place[rows] * n + place[columns], place[columns] * n + place[rows] if A.symmetric else None

    def factor(self, A: Matrix) -> None:
        if self._pattern is None or self._pattern[0] is not A.indptr or self._pattern[1] is not A.indices:
            self._analyse(A)
        self._factored, self._loose = False, None
        self._fill(A)
        if not lu(self._lu, self._pivots, self._first, self._last) > 0.0:
            self._fill(A)
            self._loose = _Loose(self._lu.copy())
            self._motions = max(self._motions, self._loose.count)
        self._factored = True
        entries = float((self._last - self._first).sum())
        self.stats = {"equations": A.n, "entries": len(A.data), "factor_entries": entries}
        if self._motions:
            self.stats["motions_without_stiffness"] = self._motions

    def _fill(self, A: Matrix) -> None:
        """The matrix, equilibrated, so that displacement and pressure rows of any units are alike."""
        M = self._lu
        M[:] = 0.0
        M.ravel()[self._at] = A.data
        if self._mirror is not None:
            M.ravel()[self._mirror] = A.data
        self._scale = d = 1.0 / np.sqrt(np.maximum(np.abs(M).max(axis=1), 1e-300))
        M *= d[:, None]
        M *= d

    def solve(self, b: Floats) -> Floats:
        assert self._factored
        x = b[self._order] * self._scale
        if self._loose is None:
            lu_solve(self._lu, self._pivots, self._first, self._last, x)
        else:
            x = self._loose.solve(x)
        out = np.empty_like(x)
        out[self._order] = x * self._scale
        return out

    def close(self) -> None:
        self._factored = False
