"""Dense LU for scenes so small that loading a sparse solver would cost more than solving."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernels.dense import lu, lu_solve
from .base import Floats, LinearError, Matrix


class Dense:
    def __init__(self) -> None:
        self.name = "dense LU"
        self.stats: dict[str, float] = {}
        self._lu: Floats | None = None
        self._scale: Floats = np.empty(0)
        self._pivots: NDArray[np.int64] = np.empty(0, np.int64)

    def factor(self, A: Matrix) -> None:
        M = np.zeros((A.n, A.n))
        rows = np.repeat(np.arange(A.n), np.diff(A.indptr))
        M[rows, A.indices] = A.data
        if A.symmetric:
            M = M + np.triu(M, 1).T
        # equilibrated, so that displacement and pressure rows of any units are alike
        d = 1.0 / np.sqrt(np.maximum(np.abs(M).max(axis=1), 1e-300))
        M *= d[:, None]
        M *= d
        self._pivots = np.empty(A.n, np.int64)
        if not lu(M, self._pivots) > 0.0:
            raise LinearError("dense LU: the matrix is singular (a body or node is not held?)")
        self._lu, self._scale = M, d
        self.stats = {"equations": A.n, "entries": len(A.data), "factor_entries": A.n**2}

    def solve(self, b: Floats) -> Floats:
        assert self._lu is not None
        x = b * self._scale
        lu_solve(self._lu, self._pivots, x)
        x *= self._scale
        return x

    def close(self) -> None:
        self._lu = None
