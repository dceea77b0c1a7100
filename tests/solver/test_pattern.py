"""Assembly: matrices that are not symmetric, in symmetric storage."""

from __future__ import annotations

import numpy as np
import pytest

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
    data, free = np.zeros(len(INDICES)), np.arange(N, dtype=np.int32)
    shuffled = K[np.ix_(order, order)][None].copy()
    pattern.scatter_any(
        shuffled, order[None], free, INDPTR.astype(np.int32), INDICES.astype(np.int32), data, np.zeros(N), np.zeros(N),
        True,
    )  # fmt: skip
    assert (_dense(data) == MIRRORED).all()


def test_tied_unknowns() -> None:
    """Each unknown is its own master, with weight one."""
    data, own, one = np.zeros(len(INDICES)), np.arange(N, dtype=np.int32), np.ones(N)
    ptr = np.arange(N + 1)
    ties.scatter(
        K[None].copy(), own[None], np.zeros(N, np.int32), ptr, own, one, one, own, 1, own,
        INDPTR.astype(np.int32), INDICES.astype(np.int32), data, np.zeros(N), np.zeros(N), True,
    )  # fmt: skip
    assert (_dense(data) == MIRRORED).all()


@pytest.mark.parametrize("upper", [True, False])
@pytest.mark.parametrize("d", [2, 5], ids=["found one by one", "looked up at once"])
def test_small_matrices_in_long_rows(d: int, upper: bool) -> None:
    """Of 20 unknowns the last is prescribed: its column goes to the right side."""
    n, rng = 20, np.random.default_rng(0)
    m = n - 1
    first = np.arange(m) if upper else np.zeros(m, int)
    indices = np.concatenate([np.arange(i, m) for i in first]).astype(np.int32)
    indptr = np.concatenate([[0], np.cumsum(m - first)]).astype(np.int32)
    dofs = np.array([rng.permutation(n)[:d] for _ in range(30)], np.int32)
    K, step, Fd, whole = rng.normal(size=(30, d, d)), rng.normal(size=n), np.zeros(n), np.zeros((n, n))
    data = np.zeros(len(indices))
    pattern.scatter_any(K, dofs, np.append(np.arange(m), -1).astype(np.int32), indptr, indices, data, step, Fd, upper)
    for k, q in zip(K, dofs, strict=True):
        whole[np.ix_(q, q)] += k
    rows = np.repeat(np.arange(m), m - first)
    np.testing.assert_allclose(data, (whole.T if upper else whole)[rows, indices], atol=1e-14)
    np.testing.assert_allclose(Fd[:m], -whole[:m, m] * step[m], atol=1e-14)
    held, before = rng.random(m) < 0.3, data.copy()
    pattern.uncouple(indptr, indices, data, held)
    alone = (held[rows] | held[indices]) & (rows != indices)
    empty = held[rows] & (rows == indices) & (before == 0.0)
    assert alone.any() and (data == np.where(alone, 0.0, np.where(empty, -1.0, before))).all()
