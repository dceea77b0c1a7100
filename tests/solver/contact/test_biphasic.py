"""Biphasic contacts: tangents against differences, patch tests, who drains."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import contact
from febkit.solver.problem import TRANSIENT, Fixed
from helpers import pair as scene
from helpers.scenes import P

TYPES = sorted(n for n in contact.TYPES if "biphasic" in n)


def make(name: str, p: scene.Pair, **kw: Any) -> Any:
    return contact.load(name)(**p.sides, **kw)


@pytest.mark.parametrize("name", TYPES)
def test_tangent_is_the_derivative(name: str) -> None:
    p = scene.Pair(skew=0.1, inset=0.05, biphasic=True)
    extra = {"symmetric_stiffness": False} if name.startswith("tied") else {}
    c = make(name, p, penalty=3.0, pressure_penalty=2.0, auto_penalty=True, **extra)
    state = scene.started(p, c)
    rng = np.random.default_rng(8)
    d = rng.uniform(-0.02, 0.02, (len(p.X), 4))
    d[np.unique(p.upper), 2] -= 0.06
    d[:, 3] = rng.uniform(-0.3, 0.3, len(p.X))
    R = scene.forces(c, state, d)
    assert np.abs(R[:, 3]).max() > 1e-4
    assert np.abs(R.sum(axis=0)).max() < 1e-12  # what one surface loses the other gains
    K, D = scene.stiffness(c, state), scene.difference(c, state, d)
    assert np.abs(K - D).max() < 1e-6 * np.abs(K).max()
    flows = np.arange(K.shape[0]) % 4 == 3
    assert np.abs((K - D)[flows]).max() < 1e-6 * np.abs(K[flows]).max()


@pytest.mark.parametrize("name", TYPES)
def test_patch(name: str) -> None:
    """Drained at the top and loaded in steps: both meshes see the same pressures as one block of their heights."""
    p = scene.Pair(n=4, biphasic=True)
    c = make(name, p, penalty=1e4, pressure_penalty=1e4)
    problem = p.problem(c, -1e-2, dtol=1e-9, ptol=1e-9)
    step = problem.steps[0]
    step.analysis, step.dt, step.count = TRANSIENT, 0.1, 2
    step.conditions += [Fixed(k, np.arange(len(p.X))) for k in (0, 1)]
    step.conditions.append(Fixed(P, p.at(p.X[:, 2].max())))
    d = scene.solve(problem).state.d
    levels = [d[p.at(z), 3] for z in (0.0, 0.5)]
    assert max(np.ptp(q) for q in levels) < 1e-6 * np.abs(levels[0]).max()
    upper, lower = d[np.unique(p.upper), 3], d[np.unique(p.lower), 3]
    assert np.ptp(upper) < 1e-6 * upper.max()
    assert upper.mean() == pytest.approx(lower.mean(), rel=1e-2)
    assert 0.0 < upper.mean() < levels[0].mean()


def test_surfaces_that_do_not_touch_drain() -> None:
    p = scene.Pair(n=4, inset=0.2, biphasic=True)
    c = make("sliding-biphasic", p, penalty=100.0, pressure_penalty=10.0)
    problem = p.problem(c, -2e-2, dtol=1e-8, ptol=1e-8)
    step = problem.steps[0]
    step.analysis, step.dt, step.count = TRANSIENT, 0.1, 2
    step.conditions += [Fixed(k, np.arange(len(p.X))) for k in (0, 1)]
    d = scene.solve(problem).state.d
    middle = np.flatnonzero((np.abs(p.X - [0.5, 0.5, 1.0]) < 1e-9).all(axis=1))
    rim = np.flatnonzero((np.abs(p.X[:, 2] - 1.0) < 1e-9) & (np.arange(len(p.X)) < p.n))
    rim = np.setdiff1d(rim, middle)
    assert np.all(d[rim, 3] == 0.0)  # beyond the upper block
    assert d[middle, 3].min() > 1e-4
