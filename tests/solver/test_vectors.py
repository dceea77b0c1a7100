"""Kernels between vectors over equations and nodal arrays, and sums that tell whether all is finite."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.finite import whole
from febkit.solver.kernels import vectors
from febkit.solver.pattern import Equations
from febkit.solver.problem import Fixed, Prescribed
from febkit.solver.values import Constant

N, COLUMNS = 7, 4
rng = np.random.default_rng(5)


@pytest.fixture()
def eqs() -> Equations:
    active = rng.random((N, COLUMNS)) < 0.8
    return Equations(active, [Fixed(0, np.array([1, 2])), Prescribed(2, np.array([2, 5, 6]), Constant(1.0))])


def test_gathered_and_placed(eqs: Equations) -> None:
    """Free unknowns take the sum of the vectors, prescribed ones their targets, all others stay."""
    nodal, target = rng.normal(size=(2, N, COLUMNS))
    out = np.empty(eqs.n)
    vectors.gather(eqs.eq, nodal, out)
    np.testing.assert_array_equal(out, nodal[eqs.numbered])
    total, increment, u = rng.normal(size=(3, eqs.n))
    want = np.where(eqs.is_given, target, nodal)
    want[eqs.is_free] = (total + increment + u)[eqs.rows]
    vectors.place(eqs.eq, eqs.free, total, increment, u, target, nodal)
    np.testing.assert_array_equal(nodal, want)
    assert eqs.is_free.any() and eqs.is_given.any() and not eqs.numbered.all()


@pytest.mark.parametrize("n", [1, 7, 8, 29])
def test_sums(n: int) -> None:
    a, v, t = rng.normal(size=(3, n))
    assert vectors.total(a) == pytest.approx(a.sum(), abs=1e-13)
    want = t + v * vectors.inner(a, t)
    vectors.add_along(v, a, t)
    np.testing.assert_array_equal(t, want)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_whole(dtype: type) -> None:
    """A sum that overflows is no sign of a number that is not finite."""
    a = np.full((3, 4), np.finfo(dtype).max, dtype)
    with np.errstate(over="ignore", invalid="ignore"):
        assert whole(a) and whole(a.T) and whole(a[:, 1]) and whole(a[:0])
        for bad in (np.nan, np.inf, -np.inf):
            a[2, 1] = bad
            assert not whole(a) and not whole(a[:, 1]) and whole(a[:, 2])
