"""Friction: tangents of points that stick and slip against differences, and Coulomb's law on a sliding block."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import contact
from febkit.solver.problem import Fixed, Prescribed, Problem, Progress, Step
from febkit.solver.values import Constant, Scaled
from helpers import pair as scene
from helpers.scenes import UX, UY, UZ


def make(p: scene.Pair, mu: float, **kw: Any) -> Any:
    return contact.load("sliding-elastic", friction=True)(**p.sides, fric_coeff=mu, **kw)


@pytest.mark.parametrize(("mu", "sticks"), [(0.2, False), (50.0, True)])
def test_tangent_is_the_derivative(mu: float, sticks: bool) -> None:
    p = scene.Pair(skew=0.1, inset=0.05)
    slide = make(p, mu, penalty=3.0)
    state = scene.started(p, slide)
    rng = np.random.default_rng(8)
    d = rng.uniform(-0.01, 0.01, p.X.shape)
    d[np.unique(p.upper), 2] -= 0.06
    state.d_old[:] = d
    state.d[:] = d
    slide.update(state, Progress(0))  # where the points were when the step began
    slide.residual(state, np.zeros_like(d))
    d = d + rng.uniform(-0.01, 0.01, p.X.shape)
    d[np.unique(p.upper), 0] += 0.05
    R = scene.forces(slide, state, d)
    acting = slide.sides[0].p > 0
    assert acting.sum() > 8
    assert (slide.sides[0].sticks[acting] == sticks).all()
    assert np.abs(R.sum(axis=0)).max() < 1e-12
    K, D = scene.stiffness(slide, state), scene.difference(slide, state, d)
    # FEBio's tangent of slip takes the dual bases as fixed where they meet the direction of slip
    assert np.abs(K - D).max() < (1e-6 if sticks else 2e-2) * np.abs(K).max()
    assert np.abs(K - K.T).max() > 1e-3 * np.abs(K).max()


@pytest.mark.parametrize(("mu", "sticks"), [(0.2, False), (50.0, True)])
def test_fluid_relieves_points_that_slip(mu: float, sticks: bool) -> None:
    p = scene.Pair(skew=0.1, inset=0.05, biphasic=True)
    slide = contact.load("sliding-biphasic", friction=True)(
        **p.sides, fric_coeff=mu, contact_frac=0.2, penalty=3.0, pressure_penalty=2.0
    )
    state = scene.started(p, slide)
    state.dt = 1.0  # by which FEBio's tangent of the relief is multiplied
    rng = np.random.default_rng(8)
    d = rng.uniform(-0.01, 0.01, (len(p.X), 4))
    d[np.unique(p.upper), 2] -= 0.06
    d[:, 3] = rng.uniform(0.0, 0.02, len(p.X))
    state.d_old[:] = state.d[:] = d
    slide.update(state, Progress(0))
    slide.residual(state, np.zeros_like(d))
    d = d + np.hstack([rng.uniform(-0.01, 0.01, p.X.shape), rng.uniform(0.0, 0.01, (len(p.X), 1))])
    d[np.unique(p.upper), 0] += 0.05
    R = scene.forces(slide, state, d)
    s = slide.sides[0]
    acting = s.p > 0
    assert (s.sticks[acting] == sticks).all()
    assert acting.sum() > 8
    assert np.abs(R.sum(axis=0)).max() < 1e-12
    if not sticks:
        m = mu * (1.0 - 0.8 * s.p1 / np.where(acting, s.p, 1.0))
        assert s.m[acting] == pytest.approx(m[acting])
        across = s.t + s.p[:, None] * s.normals
        assert np.linalg.norm(across, axis=1)[acting] == pytest.approx((m * s.p)[acting])
        assert (m[acting] < 0.95 * mu).any()
    K, D = scene.stiffness(slide, state), scene.difference(slide, state, d)
    assert np.abs((K - D)[:, 3::4]).max() < 1e-6 * np.abs(K[:, 3::4]).max()
    assert np.abs(K - D).max() < (1e-6 if sticks else 2e-2) * np.abs(K).max()


def test_the_fluid_bears_its_share_of_the_stress() -> None:
    """f = -p / (n . sigma . n): 1 where the solid bears nothing, less with it, nothing above the pressure around."""
    from febkit.solver.contact.behind import load_support
    from febkit.solver.group import Group

    p = scene.Pair(n=4, biphasic=True)
    slide = contact.load("sliding-biphasic", friction=True)(**p.sides, fric_coeff=0.1, smooth_fls=True)
    state = scene.started(p, slide)
    groups = [Group(b, p.X) for b in p.blocks]
    state.d[:, 3] = 0.4
    for g in groups:
        g.physics.pg[:] = 0.4
    s = slide.sides[0]
    assert load_support(s, groups, state, 0.0) == pytest.approx(1.0)
    assert load_support(s, groups, state, 0.1) == pytest.approx(0.75)
    groups[1].physics.s[:, :, 2] = -0.6
    assert load_support(s, groups, state, 0.0) == pytest.approx(0.4)


def test_a_block_that_slides_is_held_back_by_mu_times_its_load() -> None:
    p, mu = scene.Pair(n=4), 0.3
    slide = make(p, mu, penalty=50.0)
    top, bottom = p.at(2.0), p.at(0.0)
    conditions: list[Any] = [Fixed(k, bottom) for k in (UX, UY, UZ)]
    conditions += [Fixed(UY, top), Prescribed(UZ, top, Constant(-2e-2))]
    conditions.append(Prescribed(UX, top, Scaled(Constant(1.0), lambda t: 0.02 * t)))
    step = Step(dt=1.0, count=6, newton=scene.scenes.tight(dtol=1e-8), conditions=conditions, contacts=[slide])
    state = scene.solve(Problem(p.X, p.blocks, [step])).state
    R = np.zeros_like(state.d)
    slide.residual(state, R)
    upper = np.zeros(len(p.X), bool)
    upper[np.unique(p.top)] = True
    load = R[upper].sum(axis=0)
    side = slide.sides[0]
    assert not side.sticks[side.p > 0].any()
    assert load[2] > 0.0
    across = side.t + side.p[:, None] * side.normals
    assert np.allclose(np.linalg.norm(across, axis=1), mu * side.p, rtol=1e-9)
    assert load[0] == pytest.approx(-mu * load[2], rel=0.1)  # against the motion; points slip apart, too


def test_what_does_not_slide_sticks() -> None:
    p = scene.Pair(n=4)
    slide = make(p, 0.9, penalty=50.0)
    scene.solve(p.problem(slide, -1e-2, dtol=1e-8))
    side = slide.sides[0]
    assert side.sticks[side.p > 0].all()


def nodal(p: scene.Pair, mu: float, **kw: Any) -> Any:
    return contact.load("sliding-node-on-facet", friction=True)(**p.sides, fric_coeff=mu, fric_penalty=2.0, **kw)


@pytest.mark.parametrize(("mu", "sticks"), [(0.1, False), (50.0, True)])
def test_nodes_that_slip_are_held_by_mu_times_their_load(mu: float, sticks: bool) -> None:
    p = scene.Pair(inset=0.05)
    slide = nodal(p, mu, penalty=3.0)
    state = scene.started(p, slide)
    d = np.zeros_like(p.X)
    d[np.unique(p.top)] = [0.04, 0.02, -0.05]
    R = scene.forces(slide, state, d)
    assert np.abs(R.sum(axis=0)).max() < 1e-12
    side = slide.sides[0]
    load, area = R[side.surface.nodes], side.surface.nodal_area
    normal = load[:, 2]
    assert normal == pytest.approx(3.0 * 0.05 * area, rel=1e-9)
    drag = np.linalg.norm(load[:, :2], axis=1)
    expected = 2.0 * np.hypot(0.04, 0.02) * area if sticks else mu * normal
    assert drag == pytest.approx(expected, rel=1e-4)  # closest points are found to 1e-5
    assert (load[:, :2] @ [0.04, 0.02]).max() < 0.0
    K = scene.stiffness(slide, state)
    without = contact.load("sliding-node-on-facet")(**p.sides, penalty=3.0)
    scene.forces(without, scene.started(p, without), d)
    bare = scene.stiffness(without, state)
    assert (np.abs(K - bare).max() > 0.1) == sticks  # only nodes that stick add to the tangent
    assert np.allclose(K, K.T, atol=1e-12)


def test_first_places_move_over_with_the_node() -> None:
    p = scene.Pair(inset=0.05)
    slide = nodal(p, 50.0, penalty=3.0)
    state = scene.started(p, slide)
    side, d = slide.sides[0], np.zeros_like(p.X)
    before = side.partner.copy()
    for x in (0.1, 0.2, 0.3):
        d[np.unique(p.top)] = [x, 0.0, -0.05]
        R = scene.forces(slide, state, d)
    held = side.partner >= 0
    assert (held & (side.partner != before)).any()
    drag = R[side.surface.nodes, 0]
    inner = held & (side.surface.nodal_area > 0)
    assert drag[inner] == pytest.approx(-2.0 * 0.3 * side.surface.nodal_area[inner], rel=1e-3)
