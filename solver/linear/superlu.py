"""scipy's SuperLU, used where MKL does not install."""

from __future__ import annotations

from typing import Any

import numpy as np

from .base import Floats, LinearError, Matrix


class SuperLU:
    """Unsymmetric sparse LU with COLAMD (or, for symmetric patterns, MMD of A^T + A) ordering."""

    def __init__(self) -> None:
        self.name = "SuperLU (scipy)"
        self.stats: dict[str, float] = {}
        self._lu: Any = None

    def factor(self, A: Matrix) -> None:
        from scipy.sparse import csr_matrix, triu
        from scipy.sparse.linalg import splu

        M = csr_matrix((A.data, A.indices, A.indptr), shape=(A.n, A.n))
        if A.symmetric:
            M = M + triu(M, 1).T
        options = {"SymmetricMode": True} if A.symmetric else {}
        try:
            self._lu = splu(M.tocsc(), permc_spec="MMD_AT_PLUS_A" if A.symmetric else "COLAMD", options=options)
        except RuntimeError as e:
            raise LinearError(f"SuperLU: {e}") from None
        nnz = float(self._lu.L.nnz + self._lu.U.nnz)
        self.stats = {
            "equations": A.n, "entries": len(A.data), "factor_entries": nnz, "factor_kB": nnz * 12 / 1024,
        }  # fmt: skip

    def solve(self, b: Floats) -> Floats:
        assert self._lu is not None
        return np.asarray(self._lu.solve(np.ascontiguousarray(b)))

    def close(self) -> None:
        self._lu = None
