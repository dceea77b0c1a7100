"""Frictionless sliding: patch test, tangents against differences, what tension and multipliers do, large meshes."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest

from febkit.solver import contact
from febkit.solver.contact.penalty import automatic
from febkit.solver.contact.surface import Facets, Surface
from febkit.solver.group import Group
from febkit.solver.physics import default
from febkit.solver.problem import Block, Progress
from febkit.solver.shells import Shell, thicken
from febkit.solver.solids.isotropic_elastic import IsotropicElastic
from helpers import pair as scene

TYPES = sorted(n for n in contact.TYPES if n.startswith("sliding") and "phasic" not in n)
RNG = np.random.default_rng(5)


def make(name: str, p: scene.Pair, **kw: Any) -> Any:
    return contact.load(name)(**p.sides, **kw)


@pytest.mark.parametrize("name", TYPES)
@pytest.mark.parametrize("auto", [False, True])
def test_patch(name: str, auto: bool) -> None:
    """A uniform pressure passes from one mesh to the other; gap and pressure are those of two springs in a row."""
    p, eps = scene.Pair(n=4), 50.0
    slide = make(name, p, penalty=eps, auto_penalty=auto)
    u = scene.solve(p.problem(slide, -1e-2, dtol=1e-12)).state.d
    upper = np.zeros(len(p.X), bool)
    upper[np.unique(p.top)] = True
    (low, off), (high, off2) = scene.affine(p.X[~upper], u[~upper]), scene.affine(p.X[upper], u[upper])
    assert max(off, off2) < 1e-9  # closest points are found to 1e-5 only, as FEBio does
    assert np.abs(low - high).max() < 1e-9
    factor = scene.E * 2.0 if auto else 1.0  # elements are half a unit high below; the primary ones too
    gap = u[p.lower][..., 2].mean() - u[p.upper][..., 2].mean()
    assert gap == pytest.approx(-scene.E * low[2, 2] / (eps * factor), rel=0.03)
    pressure = np.abs(slide.pressure(slide.sides[0], scene.State.at_rest(p.problem(slide, 0.0))))
    assert pressure == pytest.approx(-scene.E * low[2, 2], rel=0.03)


@pytest.mark.parametrize("name", TYPES)
def test_tangent_is_the_derivative(name: str) -> None:
    p = scene.Pair(skew=0.1, inset=0.05)
    slide = make(name, p, penalty=3.0, knmult=1)
    state = scene.started(p, slide)
    d = np.random.default_rng(8).uniform(-0.02, 0.02, p.X.shape)
    d[np.unique(p.upper), 2] -= 0.06
    R = scene.forces(slide, state, d)
    assert (slide.sides[0].partner >= 0).sum() > 8
    assert np.abs(R.sum(axis=0)).max() < 1e-12
    rough = name.endswith("on-facet")  # closest points are found to 1e-5 only: differences need large steps
    K, D = scene.stiffness(slide, state), scene.difference(slide, state, d, 1e-3 if rough else 1e-6)
    assert np.abs(K - D).max() < (3e-3 if rough else 1e-6) * np.abs(K).max()
    without = make(name, p, penalty=3.0, knmult=0)
    state = scene.started(p, without)
    scene.forces(without, state, d)
    assert np.abs(scene.stiffness(without, state) - D).max() > 2e-2 * np.abs(K).max()


@pytest.mark.parametrize("name", TYPES)
def test_two_passes_are_the_sum_of_both(name: str) -> None:
    p = scene.Pair(skew=0.1, inset=0.05)
    sides = p.sides
    turned = {"primary": sides["secondary"], "secondary": sides["primary"]}
    d = np.random.default_rng(8).uniform(-0.02, 0.02, p.X.shape)
    d[np.unique(p.upper), 2] -= 0.06
    R, K = [], []
    for faces, two in ((sides, False), (turned, False), (sides, True)):
        slide = contact.load(name)(**faces, penalty=3.0, two_pass=two)
        state = scene.started(p, slide)
        R.append(scene.forces(slide, state, d))
        K.append(scene.stiffness(slide, state))
    assert np.allclose(R[0] + R[1], R[2], atol=1e-14)
    assert np.allclose(K[0] + K[1], K[2], atol=1e-13)
    assert np.abs(R[1]).max() > 1e-3


@pytest.mark.parametrize("name", TYPES)
def test_augmentation_closes_the_gap(name: str) -> None:
    p = scene.Pair()
    gaps = []
    for laugon in (False, True):
        slide = make(name, p, penalty=20.0, laugon=laugon, tolerance=1e-6, maxaug=40)
        scene.solve(p.problem(slide, -1e-2))
        gaps.append(np.abs(slide.sides[0].gap).max())
    assert gaps[0] > 1e-4
    assert gaps[1] < 1e-2 * gaps[0]


@pytest.mark.parametrize("name", TYPES)
def test_surfaces_apart_do_not_act(name: str) -> None:
    p = scene.Pair(gap=0.1)
    slide = make(name, p, penalty=10.0)
    state = scene.started(p, slide)
    assert np.all(scene.forces(slide, state, 0.0 * p.X) == 0.0)
    shift = np.zeros_like(p.X)
    shift[np.unique(p.top), 2] = -0.15
    R = scene.forces(slide, state, shift)
    assert R[p.upper, 2].min() >= 0.0
    assert R[:, 2].max() > 0.0
    # tension: a surface that is drawn back is held
    assert np.abs(R[:, 2].sum()) < 1e-12


def test_tension_holds_surfaces_together() -> None:
    p = scene.Pair(n=4)
    slide = make("sliding-elastic", p, penalty=100.0, tension=True)
    u = scene.solve(p.problem(slide, 1e-2)).state.d
    low, _ = scene.affine(p.X[: p.n], u[: p.n])
    assert low[2, 2] > 3e-3


def _sheet(n: int, z: float, up: bool, start: int) -> tuple[Any, Any]:
    X, _ = scene.scenes.grid((n, n, 1), (1.0, 1.0, 0.1))
    X = X[X[:, 2] < 0.05] + [0.0, 0.0, z]
    k = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    q = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4) + start
    return X, q if up else q[:, ::-1].copy()


@pytest.mark.parametrize("name", TYPES)
def test_the_search_scales(name: str) -> None:
    """1e4 facets a side are searched in milliseconds each; twice as many a side cost about four times as much."""
    taken = []
    for n in (50, 100):
        X, lower = _sheet(n, 0.0, True, 0)
        Y, upper = _sheet(n, 0.001, False, len(X))
        problem = scene.Problem(np.vstack([X, Y]), [], [scene.Step()])
        slide = contact.load(name)(scene.Facets({"quad4": upper}), scene.Facets({"quad4": lower}), search_radius=0.1)
        state = scene.State.at_rest(problem)
        slide.open(state)
        slide.update(state, Progress(1))
        best = np.inf
        for _ in range(5):
            for s in slide.sides:
                s.partner[:] = -1
            t = time.process_time()
            slide.update(state, Progress(1))
            best = min(best, time.process_time() - t)
        taken.append(best)
    assert taken[1] < 0.3
    assert taken[1] < 12 * max(taken[0], 1e-3)


def test_points_that_touch_to_rounding_have_a_tangent_alone() -> None:
    """FEBio's shells met by a rigid one without a gap as a step ends (its test sh29) turn inside out without it."""
    p = scene.Pair(gap=0.1)
    slide = make("sliding-elastic", p, penalty=10.0)
    state = scene.started(p, slide)
    shift = np.zeros_like(p.X)
    eps = np.finfo(float).eps
    cases = [(0.0, False, True), (1.0, False, True), (-1.0, False, True), (1e4, True, True), (-1e4, False, False)]
    for ulps, pushed, met in cases:
        shift[np.unique(p.top), 2] = -0.1 - ulps * eps
        R = scene.forces(slide, state, shift)
        assert (np.abs(R).max() > eps) == pushed
        assert (np.abs(scene.stiffness(slide, state)).max() > 1e-3) == met


@pytest.mark.parametrize("two_pass", [False, True])
def test_smooth_augmentation_takes_the_stress_behind(two_pass: bool) -> None:
    """A stress that is linear over the elements is found on their facets; each of two passes takes half."""
    p = scene.Pair(n=4, skew=0.1)
    slide = make("sliding-elastic", p, penalty=10.0, laugon=True, smooth_aug=True, two_pass=two_pass, tolerance=0.5)
    state = scene.State.at_rest(p.problem(slide, 0.0))
    groups = [scene.Group(b, p.X) for b in p.blocks]
    slide.begin(state, groups)
    for g in groups:
        g.physics.s[:, :, 2] = -1.0 - 0.3 * g.Xg[:, 0].reshape(g.m, g.g)
    scene.forces(slide, state, np.zeros_like(p.X))
    assert not slide.augment(0, state)
    for s in slide.passes:
        expected = (1.0 + 0.3 * s.points[:, 0]) * (0.5 if two_pass else 1.0)
        assert s.multiplier == pytest.approx(expected)
    assert slide.augment(1, state)  # they are what they were


def test_automatic_penalties_of_curved_shells_do_not_know_inside_from_outside() -> None:
    """FEBio takes the front face of a shell for its middle here, so that volumes on either side are alike."""
    a = np.linspace(0.0, 0.6, 4)
    X = np.array([(np.sin(t), y, np.cos(t)) for t in a for y in (0.0, 0.2)])
    out = np.array([[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(3)])
    found = []
    for conn in (out, out[:, ::-1].copy()):
        made = thicken(X, [Shell("quad4", conn, np.full(conn.shape, 0.2))])
        block = Block("arc", "shell_quad4", made.shells[0], np.arange(1, 4), IsotropicElastic(3.0, 0.0), default())
        g = Group(block, made.X)
        facets = Facets({"quad4": conn}, {"quad4": np.array([[0, k] for k in range(3)])})
        found.append((automatic(Surface(facets, made.X), [g]), g.wJ0.sum(axis=1)))
    (outer, thick), (inner, thin) = found
    assert outer == pytest.approx(inner)
    assert (np.abs(thick - thin) > 0.1 * thick).all()
