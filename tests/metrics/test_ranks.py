"""Spearman's rho of few values against published tables and against all orders."""

from __future__ import annotations

from itertools import permutations
from math import factorial
from time import perf_counter

import numpy as np
import pytest
from scipy.stats import rankdata, spearmanr

from febkit.metrics.agreement import fisher_z
from febkit.metrics.ranks import EXACT, spearman

# n -> least |rho| of two-sided p <= 0.05 and <= 0.01: Ramsey, J. Educ. Stat. 14 (1989) 245
CRITICAL = {
    4: (None, None), 5: (1.0, None), 6: (0.886, 1.0), 7: (0.786, 0.929), 8: (0.738, 0.881), 9: (0.700, 0.833),
    10: (0.648, 0.794), 11: (0.618, 0.755),
}  # fmt: skip


def by_squares(n: int) -> dict[float, float]:
    """rho -> p for orders of n values, one for each sum of squared differences of ranks that swaps reach."""
    out, order = {}, list(range(n))
    x, rng = np.arange(n), np.random.default_rng(1)
    seen: set[int] = set()
    for _ in range(4000):
        squares = int(((x - order) ** 2).sum())
        if squares not in seen:
            seen.add(squares)
            rho, p = spearman(x, order)
            out[round(rho, 9)] = p
        i = int(rng.integers(n - 1))
        order[i], order[i + 1] = order[i + 1], order[i]
    return out


@pytest.mark.parametrize("n", CRITICAL)
def test_critical_values_of_the_tables(n: int) -> None:
    found = by_squares(n)
    for level, critical in zip((0.05, 0.01), CRITICAL[n], strict=True):
        good = [abs(r) for r, p in found.items() if p <= level]
        assert (not good) if critical is None else min(good) == pytest.approx(critical, abs=5.1e-4)


@pytest.mark.parametrize("n", [3, 4, 5, 8, 11])
def test_the_same_order_by_chance(n: int) -> None:
    """Two of n! orders, the same and the opposite. Student's t says 0."""
    x = np.arange(n)
    assert spearman(x, x**3) == pytest.approx((1.0, 2 / factorial(n)))
    assert spearman(x, -x) == pytest.approx((-1.0, 2 / factorial(n)))
    assert spearmanr(x, x).pvalue < 1e-20


@pytest.mark.parametrize("seed", range(8))
def test_equal_values_share_their_ranks(seed: int) -> None:
    """Against all orders, one by one."""
    rng = np.random.default_rng(seed)
    x, y = rng.integers(0, 4, 7), rng.integers(0, 3, 7)
    rho, p = spearman(x, y)
    assert rho == pytest.approx(spearmanr(x, y).statistic)
    r, s = rankdata(x) - 4, rankdata(y) - 4
    sums = np.array([r @ s[list(q)] for q in permutations(range(7))])
    assert p == pytest.approx((np.abs(sums) >= abs(r @ s) - 1e-9).mean(), rel=1e-12)


def test_beyond_the_count_the_two_ways_meet() -> None:
    rng = np.random.default_rng(4)
    x, y = rng.normal(size=(2, EXACT))
    assert spearman(x, y)[1] == pytest.approx(spearmanr(x, y).pvalue, rel=0.05)
    x, y = rng.normal(size=(2, EXACT + 1))
    assert spearman(x, y) == pytest.approx(tuple(spearmanr(x, y)))
    assert 0 < spearman(np.arange(30), np.arange(30))[1] < 1e-17, "never none at all"


def test_no_number_where_there_is_none() -> None:
    for x, y in (([1, 2], [1, 2]), ([1, 1, 1], [1, 2, 3]), ([1, 2, np.nan], [1, 2, 3]), ([], [])):
        assert np.isnan(spearman(x, y)).all()


def test_counting_is_quick() -> None:
    start = perf_counter()
    spearman(np.arange(EXACT), np.roll(np.arange(EXACT), 3))
    assert perf_counter() - start < 2.0


def test_fishers_z_is_finite_and_for_enough_values() -> None:
    """Perfect order is no certainty."""
    z, p = fisher_z(np.array([1.0, 1.0, -1.0]), np.array([0.9, 1.0, 1.0]), 11, 11)
    assert np.isfinite(z).all() and (p > 0).all() and z[1] == 0 and p[1] == 1
    assert z[0] == pytest.approx(2 * (np.arctanh(1 - 12 / (11**3 - 11)) - np.arctanh(0.9)))
    for n in (2, 3, 4, 5):
        assert np.isnan(fisher_z(np.array([0.5]), np.array([0.1]), n, 11)).all()
    assert np.isfinite(fisher_z(np.array([0.5]), np.array([0.1]), 6, 6)).all()


def test_fishers_z_is_beyond_its_limit_by_chance_as_often_as_it_says() -> None:
    """Of six and of eleven values without correlation, within what ranks of so few allow."""
    rng = np.random.default_rng(2)
    for n in (6, 11):
        rho = np.array([spearmanr(*rng.normal(size=(2, n))).statistic for _ in range(2000)])
        _, p = fisher_z(rho[:1000], rho[1000:], n, n)
        assert 0.03 < (p < 0.05).mean() < 0.08
