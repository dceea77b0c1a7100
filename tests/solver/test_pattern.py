"""Assembly: matrices that are not symmetric, in symmetric storage."""

from __future__ import annotations

import numpy as np

from febkit.solver.kernels import pattern, ties

N = 4
K = np.arange(N * N, dtype=float).reshape(N, N)
INDPTR, INDICES = np.array([0, 4, 7, 9, 10]), np.array([0, 1, 2, 3, 1, 2, 3, 2, 3, 3])
MIRRORED = np.tril(K) + np.tril(K, -1).T  # what FEBio keeps: of each pair the entry below the diagonal


def _dense(data: np.ndarray) -> np.ndarray:
    out = np.zeros((N, N))
    for r in range(N):
        at = slice(INDPTR[r], INDPTR[r + 1])
        out[r, INDICES[at]] = data[at]
    return out + np.triu(out, 1).T


def test_matrices_in_any_order_of_equations() -> None:
    order = np.array([2, 0, 3, 1], np.int32)
    data, free = np.zeros(len(INDICES)), np.arange(N)
    shuffled = K[np.ix_(order, order)][None].copy()
    pattern.scatter_any(
        shuffled, order[None], free, INDPTR.astype(np.int32), INDICES.astype(np.int32), data, np.zeros(N), np.zeros(N),
        True,
    )  # fmt: skip
    assert (_dense(data) == MIRRORED).all()


def test_tied_unknowns() -> None:
    """Each unknown is its own master, with weight one."""
    data, free, eq = np.zeros(len(INDICES)), np.arange(N), np.arange(N)
    ptr, master, one = np.array([0, 1, 2, 3, 4]), np.arange(N), np.ones(N)
    ties.scatter(
        K[None].copy(), np.arange(N)[None], np.zeros(N, np.int64), ptr, master, one, one, eq, 1, free,
        INDPTR.astype(np.int32), INDICES.astype(np.int32), data, np.zeros(N), np.zeros(N), True,
    )  # fmt: skip
    assert (_dense(data) == MIRRORED).all()
