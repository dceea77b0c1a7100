"""What data say of fitted parameters, to first order: covariance, intervals, combinations that they do not tell apart.

With weighted residuals r and J = dr/dz at the best fit, cov(z) = s^2 (J^T J)^-1, where s^2 = r.r/(m - n) where the
spread of the data is not known, 1 where it is (Seber and Wild 1989, Nonlinear Regression, ch. 5).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .parameters import Parameter, Parameters

Floats = NDArray[np.float64]
BLIND = 1e-3  # singular values below this of the largest are those of what the data do not see
VAGUE = 0.25  # relative spread from which on a combination is called badly known
PART = 0.15  # what a parameter has in a combination to be named in it


@dataclass(frozen=True, slots=True)
class Direction:
    """A combination of relative changes of parameters: ``weights`` (n,), a unit vector; ``singular``: what its unit
    changes of the residuals; ``spread``: the standard deviation that is left to it."""

    weights: Floats
    singular: float
    spread: float


@dataclass(frozen=True, slots=True)
class Statistics:
    """covariance (n, n) of the values; low, high (n,): intervals of ``level``; nan of what is at its bound or unseen.

    free: which parameters are within their bounds; sigma: spread of the weighted residuals; R2: of each experiment.
    """

    covariance: Floats
    low: Floats
    high: Floats
    free: NDArray[np.bool_]
    sigma: float
    directions: tuple[Direction, ...]
    level: float = 0.95

    @property
    def deviations(self) -> Floats:
        """(n,) standard deviations."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> Floats:
        """(n, n)"""
        d = self.deviations
        return np.asarray(self.covariance / np.outer(d, d))

    @property
    def condition(self) -> float:
        """Largest over smallest singular value of the scaled Jacobian."""
        if not self.directions:
            return math.nan
        s = [d.singular for d in self.directions]
        return math.inf if s[-1] == 0 else s[0] / s[-1]


def statistics(parameters: Parameters, z: Floats, r: Floats, J: Floats, known: bool, level: float = 0.95) -> Statistics:
    """Of the fit at z with residuals r (m,) and their derivatives J (m, n); ``known``: weights are 1/sigma."""
    from scipy.special import ndtri, stdtrit  # quantiles: scipy.stats takes long to import

    values, n = parameters.values(z), len(parameters)
    width = 1e-6 * (parameters.high - parameters.low)
    free = (z > parameters.low + width) & (z < parameters.high - width)
    left = len(r) - int(free.sum())
    sigma = 1.0 if known else math.sqrt(float(r @ r) / left) if left > 0 else math.nan
    slopes = parameters.slopes(values)
    size = np.array([abs(v) if abs(v) > 1e-3 * p.size else p.size for v, p in zip(values, parameters.every)])
    few = np.zeros((max(0, n - len(r)), n))  # fewer data than parameters: what is left over is not seen
    _, s, V = np.linalg.svd(np.vstack([J / slopes * size, few])[:, free], full_matrices=False)
    seen = s > BLIND * s[0] if len(s) else np.zeros(0, bool)
    with np.errstate(divide="ignore"):
        spread = sigma / s
    cov = np.full((n, n), np.nan)
    if len(s) and s[0] > 0 and seen.all():
        column = np.sqrt((J[:, free] ** 2).sum(axis=0))
        U = J[:, free] / column
        cov[np.ix_(free, free)] = sigma**2 * np.linalg.inv(U.T @ U) / np.outer(column, column)
    q = float(ndtri(0.5 + level / 2) if known else stdtrit(max(left, 1), 0.5 + level / 2))
    half = q * np.sqrt(np.diag(cov))
    low = np.array([_outer(p, v) for p, v in zip(parameters.every, z - half)])
    high = np.array([_outer(p, v) for p, v in zip(parameters.every, z + half)])
    directions = tuple(Direction(_spread(V[k], free, n), float(s[k]), float(spread[k])) for k in range(len(s)))
    return Statistics(cov * np.outer(slopes, slopes), low, high, free, sigma, directions, level)


def _outer(p: Parameter, z: float) -> float:
    """The value that z means, not held to the bounds."""
    return math.exp(z) if p.log else z * p.size


def _spread(v: Floats, free: NDArray[np.bool_], n: int) -> Floats:
    out = np.zeros(n)
    out[free] = v
    return out


def regression(y: Floats, found: Floats) -> float:
    """R^2, the squared correlation of two curves, 0 where one does not vary: FEBio's regression coefficient."""
    a, b = y - y.mean(), found - found.mean()
    D = float(a @ a) * float(b @ b)
    return float(a @ b) ** 2 / D if D > 0 else 0.0


# ---- in words -------------------------------------------------------------------------------------------
def words(s: Statistics, names: Sequence[str]) -> list[str]:
    """What the data do not tell, a sentence each."""
    out = [f"{n} is at its bound: no interval is given" for n, free in zip(names, s.free) if not free]
    largest = s.directions[0].singular if s.directions else 0.0
    for d in s.directions:
        if d.singular <= BLIND * largest:
            out.append(_blind(d, names))
        elif d.spread > VAGUE:
            out.append(f"{_combination(d, names)} is known to {100 * d.spread:.0f} % only (one standard deviation)")
    return out


def _blind(d: Direction, names: Sequence[str]) -> str:
    part = _parts(d, names)
    if len(part) == 1:
        return f"the data say nothing of {part[0][0]}"
    first, *rest = part
    turned = 1.0 if first[1] > 0 else -1.0
    moves = [f"{n} {'up' if w * turned > 0 else 'down'} {abs(w / first[1]):.2g} %" for n, w in rest]
    listed = ", ".join(n for n, _ in part[:-1]) + f" and {part[-1][0]}"
    return (f"the data do not tell {listed} apart: {first[0]} up 1 % with {', '.join(moves)} changes next to nothing")


def _combination(d: Direction, names: Sequence[str]) -> str:
    part = _parts(d, names)
    if len(part) == 1:
        return part[0][0]
    first = part[0][1]
    return "the combination " + " ".join(f"{n}^{w / first:.2g}" if w != first else n for n, w in part)


def _parts(d: Direction, names: Sequence[str]) -> list[tuple[str, float]]:
    """The parameters that make a combination, the heaviest first."""
    part = [(n, float(w)) for n, w in zip(names, d.weights) if abs(w) >= PART]
    return sorted(part, key=lambda p: -abs(p[1]))
