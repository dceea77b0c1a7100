"""Sticky contact: when nodes are caught and let go, and the tangent against differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import contact
from helpers import pair as scene


def make(p: scene.Pair, **kw: Any) -> Any:
    return contact.load("sticky")(**p.sides, **kw)


def caught(c: Any) -> int:
    return int((c.sides[0].partner >= 0).sum())


def shifted(p: scene.Pair, z: float, x: float = 0.0) -> Any:
    d = np.zeros_like(p.X)
    d[np.unique(p.top)] = [x, 0.0, z]
    return d


def test_nodes_are_caught_within_the_snap_tolerance_and_stay() -> None:
    p = scene.Pair(gap=0.1, inset=0.05)
    c = make(p, snap_tol=0.02, penalty=2.0)
    state = scene.started(p, c)
    for z, count in ((0.0, 0), (-0.079, 0), (-0.081, 16), (0.1, 16)):
        R = scene.forces(c, state, shifted(p, z, 0.03))
        assert caught(c) == count
    side = c.sides[0]
    area = side.surface.nodal_area
    first = 0.1 - 0.081  # where they were caught the gap already counted
    assert R[side.surface.nodes, 2] == pytest.approx(-2.0 * (first + 0.181) * area)
    assert np.abs(R[side.surface.nodes, :2]).max() < 1e-12  # the places on the other surface are those of the catch
    assert np.abs(R.sum(axis=0)).max() < 1e-12


def test_a_traction_too_large_lets_go() -> None:
    p = scene.Pair(inset=0.05)
    c = make(p, max_traction=0.1, penalty=2.0, snap_tol=0.001)
    state = scene.started(p, c)
    assert caught(c) == 0  # what only touches is not caught at the start
    for z, count in ((-0.01, 16), (0.049, 16), (0.051, 0), (0.049, 0), (0.0005, 16)):
        R = scene.forces(c, state, shifted(p, z))
        assert caught(c) == count
        assert (np.abs(R).max() > 0.0) == (count > 0)
    scene.forces(c, state, shifted(p, 0.0005, 0.2))  # tractions along the surface count for nothing
    assert caught(c) == 16


def test_the_gap_offset_is_along_the_normal_at_rest() -> None:
    p = scene.Pair(gap=0.1, inset=0.05)
    c = make(p, gap_offset=0.12)
    scene.started(p, c)
    assert caught(c) == 16
    assert c.sides[0].gap[:, 2] == pytest.approx(-0.02)


def test_tangent_is_the_derivative() -> None:
    p = scene.Pair(skew=0.1, inset=0.05)
    c = make(p, penalty=3.0, snap_tol=1.0, max_traction=5.0)
    state = scene.started(p, c)
    d = np.random.default_rng(3).uniform(-0.03, 0.03, p.X.shape)
    R = scene.forces(c, state, d)
    R = scene.forces(c, state, d + np.random.default_rng(4).uniform(-0.03, 0.03, p.X.shape))
    assert np.abs(R).max() > 1e-4
    K = scene.stiffness(c, state)
    assert np.abs(K - scene.difference(c, state, d)).max() < 1e-7 * np.abs(K).max()


def test_a_failed_step_gives_back_what_was_caught() -> None:
    p = scene.Pair(gap=0.1, inset=0.05)
    c = make(p, snap_tol=0.02)
    state = scene.started(p, c)
    saved = c.snapshot()
    scene.forces(c, state, shifted(p, -0.2))
    assert caught(c) == 16
    c.restore(saved)
    assert caught(c) == 0
