"""Dense LU of small systems against LAPACK, and when it is chosen."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from febkit.solver.linear.base import LinearError, Matrix
from febkit.solver.linear.choose import DENSE_LIMIT, choose
from febkit.solver.linear.dense import Dense, narrow


def _compressed(M: np.ndarray, symmetric: bool) -> Matrix:
    rows, columns = np.nonzero((np.triu(M) if symmetric else M) + np.eye(len(M)))
    indptr = np.zeros(len(M) + 1, np.int32)
    np.cumsum(np.bincount(rows, minlength=len(M)), out=indptr[1:])
    return Matrix(indptr, columns.astype(np.int32), M[rows, columns].copy(), symmetric)


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("n", [1, 2, 7, 150])
def test_as_lapack(n: int, symmetric: bool) -> None:
    rng = np.random.default_rng(n)
    M = np.where(rng.random((n, n)) < 0.3, rng.normal(size=(n, n)), 0.0) + 2.0 * np.diag(rng.choice([-1, 1], n))
    units = 10.0 ** rng.uniform(-8, 8, n)  # displacement and pressure rows in any units
    M = (M + M.T if symmetric else M) * units[:, None] * units
    solver = Dense()
    solver.factor(_compressed(M, symmetric))
    for _ in range(2):
        b = rng.normal(size=n)
        kept = b.copy()
        x = solver.solve(b)
        np.testing.assert_array_equal(b, kept)
        np.testing.assert_allclose(M @ x, b, rtol=1e-6, atol=1e-8 * np.abs(M * x).max())


def test_unknowns_are_ordered_into_a_band() -> None:
    n, shuffled = 60, np.random.default_rng(3).permutation(60)
    band = np.abs(np.subtract.outer(np.arange(n), np.arange(n))) <= 2
    order = narrow(band[np.ix_(shuffled, shuffled)])
    assert sorted(order) == list(range(n))
    i, j = np.nonzero(band[np.ix_(shuffled[order], shuffled[order])])
    assert np.abs(i - j).max() <= 4


def test_bodies_apart_are_all_ordered() -> None:
    joined = np.kron(np.eye(5), np.ones((3, 3))).astype(bool)
    assert sorted(narrow(joined)) == list(range(15))


def test_a_new_pattern_is_seen() -> None:
    solver = Dense()
    for n in (4, 6):
        M = 3.0 * np.eye(n) + np.eye(n, k=1)
        solver.factor(_compressed(M, False))
        np.testing.assert_allclose(M @ solver.solve(np.arange(n, dtype=float)), np.arange(n), atol=1e-14)


def test_rows_are_exchanged_where_a_pivot_is_zero() -> None:
    solver = Dense()
    solver.factor(_compressed(np.array([[0.0, 2.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, 5.0]]), False))
    np.testing.assert_allclose(solver.solve(np.array([2.0, 6.0, 5.0])), [2.0, 1.0, 1.0], rtol=1e-15)


@pytest.mark.parametrize("M", [np.zeros((2, 2)), np.ones((3, 3)), np.diag([1.0, 0.0])])
def test_a_singular_matrix_is_said(M: np.ndarray) -> None:
    solver = Dense()
    solver.factor(_compressed(M, False))
    with pytest.raises(LinearError, match="singular"):
        solver.solve(np.arange(1.0, len(M) + 1.0))


def test_motions_without_stiffness_stay_where_nothing_loads_them() -> None:
    M = np.array([[2.0, -2.0, 0.0], [-2.0, 2.0, 0.0], [0.0, 0.0, 3.0]])  # a spring that nothing holds
    solver = Dense()
    solver.factor(_compressed(M, False))
    np.testing.assert_allclose(solver.solve(np.array([1.0, -1.0, 6.0])), [0.25, -0.25, 2.0], rtol=1e-14)
    assert solver.stats["motions_without_stiffness"] == 1
    with pytest.raises(LinearError, match="singular"):
        solver.solve(np.array([1.0, -0.9, 6.0]))


def test_small_scenes_load_neither_mkl_nor_scipy() -> None:
    assert isinstance(choose("auto", DENSE_LIMIT, 2), Dense)
    program = (
        "import sys; from febkit.solver.linear.choose import choose; choose('auto', 100, 2)\n"
        "maps = open('/proc/self/maps').read() if sys.platform == 'linux' else ''\n"
        "print('scipy' in sys.modules, 'libmkl' in maps)"
    )
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert said.stdout.split() == ["False", "False"]
