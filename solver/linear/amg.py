"""Smoothed-aggregation multigrid (pyamg) for the two blocks of a tangent: elasticity and pressure."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .base import Floats, LinearError

COARSEST = 50  # nodes whose unknowns are inverted densely
MISSING = "the iterative linear solver needs pyamg: pip install 'febkit[amg]'"


def available() -> bool:
    """Is pyamg installed?"""
    return find_spec("pyamg") is not None


def require() -> None:
    """Raises LinearError with what to install where pyamg is missing."""
    if not available():
        raise LinearError(MISSING)


def rigid_modes(X: Floats, free: NDArray[np.bool_]) -> Floats:
    """Translations and rotations (3 node, 6) of nodes X (node, 3), zero at components that are not ``free``.

    Positions are taken from the centre over the size, so that all modes are of one magnitude.
    """
    x = X - X.mean(axis=0)
    x /= max(float(np.abs(x).max()), 1e-300)
    B = np.zeros((len(X), 3, 6))
    B[:, range(3), range(3)] = 1.0
    for mode, (i, j) in enumerate(((0, 1), (1, 2), (2, 0)), start=3):
        B[:, i, mode], B[:, j, mode] = -x[:, j], x[:, i]
    B[~free] = 0.0
    return B.reshape(-1, 6)


class Multigrid:
    """A hierarchy for a symmetric positive definite sparse matrix; ``modes`` (n, k) span its near null space."""

    def __init__(self, A: Any, modes: Floats, strength: float, sweeps: int = 1) -> None:
        from pyamg import smoothed_aggregation_solver

        smoother = ("block_gauss_seidel" if modes.shape[1] > 1 else "gauss_seidel",
                    {"sweep": "symmetric", "iterations": sweeps})  # fmt: skip
        self._hierarchy = smoothed_aggregation_solver(
            A, B=modes, strength=("symmetric", {"theta": strength}), improve_candidates=None,
            presmoother=smoother, postsmoother=smoother, max_coarse=COARSEST, coarse_solver="pinv",
        )  # fmt: skip

    @property
    def entries(self) -> int:
        """Stored entries of all levels and the maps between them."""
        parts = [p for k in self._hierarchy.levels for p in (k.A, getattr(k, "P", None)) if p is not None]
        return sum(len(p.data.ravel()) for p in parts)

    def cycle(self, b: Floats, level: int = 0) -> Floats:
        """One V-cycle on b from nothing."""
        levels = self._hierarchy.levels
        here, x = levels[level], np.zeros_like(b)
        if level == len(levels) - 1:
            return np.asarray(self._hierarchy.coarse_solver(here.A, b)).ravel()
        here.presmoother(here.A, x, b)
        x += here.P @ self.cycle(here.R @ (b - here.A @ x), level + 1)
        here.postsmoother(here.A, x, b)
        return x
