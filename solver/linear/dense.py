"""LAPACK's dense LU for scenes so small that loading a sparse solver would cost more than solving."""

from __future__ import annotations

import numpy as np

from .base import Floats, LinearError, Matrix


class Dense:
    def __init__(self) -> None:
        self.name = "dense LU (LAPACK)"
        self.stats: dict[str, float] = {}
        self._inverse: Floats | None = None

    def factor(self, A: Matrix) -> None:
        M = np.zeros((A.n, A.n))
        rows = np.repeat(np.arange(A.n), np.diff(A.indptr))
        M[rows, A.indices] = A.data
        if A.symmetric:
            M = M + np.triu(M, 1).T
        # equilibrated, so that displacement and pressure rows of any units are alike
        d = 1.0 / np.sqrt(np.maximum(np.abs(M).max(axis=1), 1e-300))
        try:
            inverse = np.linalg.inv(M * d[:, None] * d[None, :])
        except np.linalg.LinAlgError:
            raise LinearError("dense LU: the matrix is singular (a body or node is not held?)") from None
        self._inverse = inverse * d[:, None] * d[None, :]
        self.stats = {"equations": A.n, "entries": len(A.data), "factor_entries": A.n**2}

    def solve(self, b: Floats) -> Floats:
        assert self._inverse is not None
        return self._inverse @ b

    def close(self) -> None:
        self._inverse = None
