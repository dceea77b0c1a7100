"""The consistent mass, element by element, against its sum over node pairs."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.mass import Mass


class _Group:
    def __init__(self, conn, N, w) -> None:
        self.conn, self.N, self.wJ0 = np.asarray(conn, np.int32), N, w
        self.m, self.g = w.shape
        self.block = self
        self.solid = self

    def points(self) -> None: ...

    def density(self, pts: object) -> np.ndarray:
        return np.array([3.0])


@pytest.fixture()
def mass() -> Mass:
    rng = np.random.default_rng(0)
    conn = [[0, 1, 2, 3], [2, 3, 4, 5], [4, 5, 6, 7]]
    return Mass([_Group(conn, rng.random((8, 4)), rng.random((3, 8)) + 0.5)])  # type: ignore[list-item]


def _whole(mass: Mass) -> np.ndarray:
    out = np.zeros((9, 9))
    for g, M in mass.parts:
        for e, nodes in enumerate(g.conn):
            out[np.ix_(nodes, nodes)] += M[e]
    return out


def test_product_and_diagonal(mass: Mass) -> None:
    a = np.random.default_rng(1).normal(size=(9, 3))
    np.testing.assert_allclose(mass @ a, _whole(mass) @ a, rtol=1e-13)
    np.testing.assert_allclose(mass.diagonal(9), np.diag(_whole(mass)), rtol=1e-14)


def test_density_is_in_it(mass: Mass) -> None:
    ((g, M),) = mass.parts
    np.testing.assert_allclose(M[0], 3.0 * (g.N.T * g.wJ0[0]) @ g.N, rtol=1e-13)


def test_solve_over_free_unknowns(mass: Mass) -> None:
    rng = np.random.default_rng(2)
    free = rng.random((9, 3)) < 0.7
    f = rng.normal(size=(9, 3))
    a = mass.solve(f, free)
    M = _whole(mass)
    for i in range(3):
        rows = np.flatnonzero(free[:8, i])  # node 8 has no mass
        np.testing.assert_allclose(a[rows, i], np.linalg.solve(M[np.ix_(rows, rows)], f[rows, i]), rtol=1e-9)
    assert not a[~free].any() and not a[8].any()
    assert not mass.solve(np.zeros((9, 3)), free).any()
