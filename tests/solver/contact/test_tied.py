"""Tied contacts: patch test, tangents against differences, augmentation, and what is left untied."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import contact
from helpers import pair as scene

TYPES = sorted(n for n in contact.TYPES if n.startswith("tied") and "phasic" not in n)
RNG = np.random.default_rng(3)


def make(name: str, p: scene.Pair, **kw: Any) -> Any:
    return contact.load(name)(**p.sides, **kw)


@pytest.mark.parametrize("name", TYPES)
def test_patch(name: str) -> None:
    """A uniform stress passes from one mesh to the other, whatever the penalty: both blocks deform alike."""
    p, eps = scene.Pair(n=4), 50.0
    tie = make(name, p, penalty=eps)
    u = scene.solve(p.problem(tie, -1e-2, dtol=1e-11)).state.d
    upper = np.zeros(len(p.X), bool)
    upper[np.unique(p.top)] = True
    (low, off), (high, off2) = scene.affine(p.X[~upper], u[~upper]), scene.affine(p.X[upper], u[upper])
    assert max(off, off2) < 1e-10
    assert np.abs(low - high).max() < 1e-10
    gap = u[p.upper][..., 2].mean() - u[p.lower][..., 2].mean()
    stress = scene.E * low[2, 2]
    assert gap == pytest.approx(stress / eps, rel=0.02)  # strains are of some per cent


@pytest.mark.parametrize("name", TYPES)
@pytest.mark.parametrize("two_pass", [False, True])
def test_tangent_is_the_derivative(name: str, two_pass: bool) -> None:
    if two_pass and name != "tied-elastic":
        pytest.skip("has one pass only")
    p = scene.Pair(gap=0.05, skew=0.1)
    extra = {"two_pass": two_pass, "symmetric_stiffness": False, "auto_penalty": True} if name == "tied-elastic" else {}
    tie = make(name, p, penalty=3.0, **extra)
    state = scene.started(p, tie)
    d = RNG.uniform(-0.03, 0.03, p.X.shape)
    R = scene.forces(tie, state, d)
    assert np.abs(R).max() > 1e-4
    assert np.abs(R.sum(axis=0)).max() < 1e-12  # the surfaces act on each other alone
    K = scene.stiffness(tie, state)
    assert np.abs(K - scene.difference(tie, state, d)).max() < 1e-7 * np.abs(K).max()


def test_the_symmetric_stiffness_is_the_symmetric_part() -> None:
    p = scene.Pair(skew=0.1)
    full, half = (make("tied-elastic", p, penalty=3.0, symmetric_stiffness=s) for s in (False, True))
    d = RNG.uniform(-0.03, 0.03, p.X.shape)
    K = []
    for tie in (full, half):
        state = scene.started(p, tie)
        scene.forces(tie, state, d)
        K.append(scene.stiffness(tie, state))
    assert np.abs(K[0] - K[0].T).max() > 1e-3 * np.abs(K[0]).max()
    assert np.allclose(K[1], 0.5 * (K[0] + K[0].T), atol=1e-12)


@pytest.mark.parametrize("name", TYPES)
def test_augmentation_closes_the_gap(name: str) -> None:
    p = scene.Pair()
    gaps = []
    for laugon in (False, True):
        tie = make(name, p, penalty=20.0, laugon=laugon, tolerance=1e-6, maxaug=40)
        scene.solve(p.problem(tie, -1e-2))
        gaps.append(np.abs(tie.sides[0].gap).max())
    assert gaps[0] > 1e-4
    assert gaps[1] < 1e-2 * gaps[0]


def test_nodes_too_far_are_left() -> None:
    p = scene.Pair(gap=0.2)
    for distance, count in ((0.1, 0), (0.3, 16)):
        tie = make("tied-node-on-facet", p, max_distance=distance)
        scene.started(p, tie)
        assert (tie.sides[0].partner >= 0).sum() == count
