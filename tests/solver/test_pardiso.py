"""LDL^T without pivoting where matrices have one, with it where they do not."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from scipy import sparse

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


def grid(n: int, wind: float) -> Matrix:
    """Diffusion on n^3 nodes; ``wind``: what carries along one axis, which takes symmetry away."""
    line = sparse.diags_array([-1.0, 2.1, -1.0], offsets=[-1, 0, 1], shape=(n, n))
    one = sparse.eye_array(n)
    full = sum(sparse.kron(sparse.kron(a, b), c) for a, b, c in ((line, one, one), (one, line, one), (one, one, line)))
    full = full + wind * sparse.kron(sparse.kron(sparse.diags_array([1.0], offsets=[1], shape=(n, n)), one), one)
    A = (full if wind else sparse.triu(full)).tocsr()
    A.sort_indices()
    return Matrix(A.indptr.astype(np.int32), A.indices.astype(np.int32), A.data, not wind)


@pytest.mark.parametrize("wind", [0.0, 0.3])
def test_two_threads_solve_to_the_same_bits_however_busy_the_machine_is(wind):
    """Left to themselves MKL's threads add in the order in which they come: which shows in some of these solves."""
    A = grid(22, wind)
    b = np.random.default_rng(0).random(A.n)
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]
    try:
        found = set()
        for _ in range(2):
            solver = Pardiso(2, single=True)
            solver.factor(A)
            found |= {solver.solve(b).tobytes() for _ in range(60)}
            solver.close()
    finally:
        for p in busy:
            p.kill()
            p.wait()
    assert len(found) == 1
