"""Rank correlation of a few values, and how likely chance makes one as large."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import factorial

import numpy as np
from numpy.typing import ArrayLike, NDArray

EXACT = 11  # values up to which all orders are counted; beyond, scipy's t-distribution is within a few per cent


def spearman(x: ArrayLike, y: ArrayLike) -> tuple[float, float]:
    """Spearman's rho (Pearson's correlation of the ranks, equal values sharing theirs), and its two-sided p-value.

    p = share of the n! orders of one sample with |rho| as large, counted for n <= 11. Kendall & Gibbons, Rank
    Correlation Methods (1990), ch. 4. NaN of fewer than three values, of values that do not vary, and of NaN.
    """
    from scipy.stats import rankdata, spearmanr

    a, b = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    n = len(a)
    if n < 3 or not (np.isfinite(a).all() and np.isfinite(b).all() and np.ptp(a) > 0 and np.ptp(b) > 0):
        return np.nan, np.nan
    if n > EXACT:
        rho, p = (float(v) for v in spearmanr(a, b))
        return rho, max(p, 2.0 / factorial(min(n, 20)))
    r, s = (np.rint(2 * rankdata(v)).astype(np.int64) for v in (a, b))
    dr, ds = n * r - r.sum(), n * s - s.sum()  # in whole numbers: |rho| is compared without rounding
    rho = float(dr @ ds / np.sqrt(float(dr @ dr) * float(ds @ ds)))
    count = _sums(tuple(sorted(r.tolist())), tuple(sorted(s.tolist())))
    away = np.abs(n * np.arange(len(count)) - r.sum() * s.sum())
    return rho, float(count[away >= abs(n * int(r @ s) - r.sum() * s.sum())].sum() / factorial(n))


@lru_cache(maxsize=64)
def _sums(a: Sequence[int], b: Sequence[int]) -> NDArray[np.int64]:
    """In how many orders q the sum of a_i b_q(i) takes the values 0, 1, 2, ...

    The first i of a are matched with each set of i of b in turn: 2^n sets in place of n! orders.
    """
    most = sum(p * q for p, q in zip(a, b, strict=True))  # both in order: no other order gives more
    start = np.zeros(most + 1, np.int64)
    start[0] = 1
    sets = {0: start}
    for p in a:
        larger: dict[int, NDArray[np.int64]] = {}
        for taken, count in sets.items():
            for j, q in enumerate(b):
                if taken >> j & 1:
                    continue
                into = larger.setdefault(taken | 1 << j, np.zeros(most + 1, np.int64))
                into[p * q :] += count[: most + 1 - p * q]
        sets = larger
    return sets[(1 << len(b)) - 1]
