"""LDL^T without pivoting where matrices have one, with it where they do not."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.linear.base import Matrix
from febkit.solver.linear.pardiso import Pardiso, library

pytestmark = pytest.mark.skipif(library() is None, reason="MKL is not installed")


def upper(full: np.ndarray) -> Matrix:
    rows, columns = np.nonzero(np.triu((full != 0.0) | np.eye(len(full), dtype=bool)))
    indptr = np.searchsorted(rows, np.arange(len(full) + 1)).astype(np.int32)
    return Matrix(indptr, columns.astype(np.int32), full[rows, columns].copy(), True)


def solved(full: np.ndarray, single: bool = False) -> tuple[Pardiso, float]:
    """The solver, and the relative error of a solution."""
    x = np.random.default_rng(5).normal(size=len(full))
    solver = Pardiso(1, single, mixed=True)
    solver.factor(upper(full))
    return solver, float(np.linalg.norm(solver.solve(full @ x) - x) / np.linalg.norm(x))


def blocks(n: int, corner: float, coupling: float = 1.0) -> np.ndarray:
    """[[K, B], [B^T, -C]]: K positive definite, C = ``corner`` I."""
    rng = np.random.default_rng(2)
    K = rng.normal(size=(n, n)) * (rng.random((n, n)) < 0.2)
    K = K @ K.T + n * np.eye(n)
    B = coupling * rng.normal(size=(n, n // 2)) * (rng.random((n, n // 2)) < 0.3)
    return np.block([[K, B], [B.T, -corner * np.eye(n // 2)]])


@pytest.mark.parametrize("single, most", [(False, 1e-12), (True, 1e-3)])
@pytest.mark.parametrize("corner", [1.0, 1e-3])
def test_quasi_definite_matrices_need_no_pivoting(single, most, corner):
    solver, error = solved(blocks(40, corner), single)
    assert error < most and not solver.stats["pivoting"]


def test_definite_matrices_need_no_pivoting():
    solver, error = solved(blocks(40, 1.0)[:40, :40])
    assert error < 1e-12 and not solver.stats["pivoting"]


def without_diagonal(size: float) -> np.ndarray:
    """Symmetric, indefinite, well conditioned, with ``size`` on its diagonal."""
    rng = np.random.default_rng(4)
    full = rng.normal(size=(40, 40))
    full = full + full.T
    np.fill_diagonal(full, size)
    return full


@pytest.mark.parametrize("size", [0.0, 1e-11])
def test_others_are_pivoted(size):
    """A pivot of nought is perturbed; small ones are not, but what they leave is worthless: that is noticed."""
    full = without_diagonal(size)
    assert np.linalg.cond(full) < 1e3
    solver, error = solved(full)
    assert error < 1e-10 and solver.stats["pivoting"]


def test_pivoting_is_kept_for_what_follows():
    full = np.kron(np.eye(20), [[0.0, 1.0], [1.0, 0.0]])
    solver, _ = solved(full)
    solver.factor(upper(full))
    assert solver.stats["pivoting"] and solver.stats["perturbed_pivots"] == 0.0
