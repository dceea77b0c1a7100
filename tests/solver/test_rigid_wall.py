"""A plane that nodes may not pass."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver.loads.base import patches
from febkit.solver.loads.rigid_wall import RigidWall
from febkit.solver.problem import Fixed, NewtonOptions, Problem, Step
from febkit.solver.run import run
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.state import State
from febkit.solver.values import Constant
from helpers import scenes

X = scenes.grid((1, 1, 2))[0]
TOP = np.flatnonzero(X[:, 2] > X[:, 2].max() - 1e-9)
TOP_FACET = TOP[[0, 1, 3, 2]][None]


def wall(plane: tuple[float, ...], **options: Any) -> RigidWall:
    a, b, c, d = map(Constant, plane)
    return RigidWall(patches({"quad4": TOP_FACET}, X), (a, b, c, d), **options)


def column(step: Step) -> Problem:
    return Problem(X, [scenes.block("hex8", scenes.grid((1, 1, 2))[1], NeoHookean(E=2.0, v=0.3))], [step])


def test_tangent() -> None:
    """Two nodes are behind the tilted wall, two before it."""
    n = np.array([0.6, 0.0, -0.8])
    w = wall((*n, float(n @ X[TOP].mean(axis=0))), penalty=7.0)
    state = State.at_rest(column(Step(loads=[w])))
    state.layout.u(state.d)[:] = np.random.default_rng(3).uniform(-0.02, 0.02, X.shape)
    ((K, nodes, columns),) = w.stiffness(state)
    assert len(K) == 2
    full = np.zeros((state.d.size, state.d.size))
    for k, row in zip(K, nodes, strict=True):
        at = row * state.d.shape[1] + columns
        full[np.ix_(at, at)] += k

    def force() -> np.ndarray:
        R = np.zeros_like(state.d)
        w.residual(state, R)
        return R.ravel()

    d, h = state.d.ravel(), 1e-6
    for j in range(d.size):
        d[j] += h
        up = force()
        d[j] -= 2 * h
        down = force()
        d[j] += h
        np.testing.assert_allclose(full[:, j], (down - up) / (2 * h), atol=1e-8)


def pressed(**options: Any) -> np.ndarray:
    """How far the top of a block went down, (4,), under a wall that came down by 0.1."""
    low, high = np.flatnonzero(X[:, 2] < 1e-9), X[:, 2].max()
    step = Step(
        loads=[wall((0.0, 0.0, -1.0, -high), offset=0.1, **options)], conditions=[Fixed(k, low) for k in range(3)],
        dt=1.0, count=1, newton=NewtonOptions(method="full Newton", updates=0, dtol=1e-9, etol=0.0, min_residual=1e-26),
    )  # fmt: skip
    result = run(column(step))
    assert result.converged, result.reason
    return np.asarray(high - result.state.x[TOP, 2])


def test_the_force_is_the_penalty_times_area_and_gap() -> None:
    """Twice the penalty moves the nodes on; their gaps times the penalty stay the force of the column."""
    gaps = {eps: 0.1 - pressed(penalty=eps) for eps in (50.0, 100.0, 200.0)}
    forces = {eps: eps * g.mean() for eps, g in gaps.items()}
    assert all((g > 0.0).all() for g in gaps.values())
    # the column is a spring k in series with the penalty: 1/f is linear in 1/eps, but for its own nonlinearity
    a, b, c = (1.0 / forces[e] for e in (50.0, 100.0, 200.0))
    assert (a - b) / (b - c) == pytest.approx(2.0, rel=0.02)


def test_multipliers_close_the_gap() -> None:
    by_penalty = np.abs(0.1 - pressed(penalty=50.0)).max()
    augmented = np.abs(0.1 - pressed(penalty=50.0, laugon=1, tolerance=1e-8)).max()
    assert augmented < 1e-6 < 1e-3 < by_penalty
