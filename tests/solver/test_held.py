"""Constraints that hold normal displacements, distances and enclosed volumes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver.action import Action
from febkit.solver.elements import nodal
from febkit.solver.fields import DISPLACEMENT, Layout
from febkit.solver.loads.base import patches
from febkit.solver.loads.enclosed_volume import EnclosedVolume
from febkit.solver.loads.held_normals import HeldNormals, normals
from febkit.solver.loads.nodal import NodalForce
from febkit.solver.loads.node_distance import NodeDistance
from febkit.solver.problem import Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.run import run
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.state import State
from febkit.solver.values import Constant
from helpers import scenes

LAYOUT = Layout([DISPLACEMENT])
X, CONN = scenes.grid((1, 1, 2))
BOX = np.array([[0, 3, 9, 6], [0, 6, 8, 2], [6, 9, 11, 8], [9, 3, 5, 11], [3, 0, 2, 5], [2, 8, 11, 5]])  # outward
LOW = np.array([[0, 3, 9, 6], [0, 6, 7, 1]])  # bottom and front of the lower element: an edge between them


def state(amount: float = 0.05, at: Any = X) -> State:
    u = amount * np.random.default_rng(5).normal(size=at.shape)
    return State(LAYOUT, at, u, 0.5 * u, *(np.zeros_like(at) for _ in range(5)), time=1.0, dt=0.5)


def forces(load: Action, s: State) -> np.ndarray:
    R = np.zeros_like(s.d)
    load.residual(s, R)
    return R.ravel()


def assembled(load: Action, s: State) -> np.ndarray:
    full = np.zeros((s.d.size, s.d.size))
    for K, nodes, columns in load.stiffness(s):
        for k, n in zip(K, nodes, strict=True):
            at = n * s.d.shape[1] + columns
            full[np.ix_(at, at)] += k
    return full


def measured(load: Action, s: State, h: float = 1e-6) -> np.ndarray:
    out = np.zeros((s.d.size, s.d.size))
    for j in range(s.d.size):
        parts = []
        for step in (h, -h):
            s.d.flat[j] += step
            parts.append(forces(load, s))
            s.d.flat[j] -= step
        out[:, j] = -(parts[0] - parts[1]) / (2 * h)
    return out


def held(**options: Any) -> HeldNormals:
    nodes = np.unique(LOW)
    return HeldNormals.of((LOW,), nodes, nodes, LAYOUT.displacement, **options)


def volume(rule: str = nodal.RULE, **options: Any) -> EnclosedVolume:
    return EnclosedVolume(patches({"quad4": BOX}, X, rules={"quad4": rule}), **options)


LOADS = {
    "normals": lambda: held(penalty=3.0),
    "distance": lambda: NodeDistance(np.array([2, 9]), 4.0, 0.3),
    "distance of its own": lambda: NodeDistance(np.array([2, 9]), 4.0, 0.3, relative=False),
    "volume": lambda: volume(penalty=0.0),
}


@pytest.mark.parametrize("name", LOADS)
def test_tangent_is_minus_the_derivative_of_the_force(name: str) -> None:
    load, s = LOADS[name](), state()
    load.begin(s, [])
    if isinstance(load, EnclosedVolume):
        load.multiplier = 0.7
    s.d[:] = state(0.1).d[::-1]
    exact = measured(load, s)
    if isinstance(load, EnclosedVolume):  # at the nodes alone, the facets' parts that are not symmetric do not cancel
        exact = 0.5 * (exact + exact.T)
    np.testing.assert_allclose(assembled(load, s), exact, atol=1e-7)
    assert np.abs(exact).max() > 0.1


def test_normals_of_a_bent_surface() -> None:
    n = normals(X, (LOW,))
    np.testing.assert_allclose(n[3], [0.0, 0.0, -1.0])
    np.testing.assert_allclose(n[0], np.array([0.0, -0.5, -1.0]) / np.sqrt(1.25))  # areas 1/2 and 1
    assert not n[4].any()


@pytest.mark.parametrize("kind", ["tri6", "quad8"])
def test_normals_of_curved_facets_point_one_way(kind: str) -> None:
    e = scenes.elements.get(kind)
    x = np.column_stack([e.natural, 0.05 * (e.natural**2).sum(axis=1)])
    n = normals(x, (np.arange(len(x))[None],))
    assert (n[:, 2] > 0.9).all()


def test_volume_of_a_box_and_its_derivative() -> None:
    load, s = volume("G4"), state(0.0)
    assert load.volume(s) == pytest.approx(1.0)
    s.d[:] = state(0.1).d
    load.multiplier = 1.0
    f = forces(load, s)  # with a unit pressure, dV/dx
    for j in range(s.d.size):
        ends = []
        for h in (1e-6, -1e-6):
            s.d.flat[j] += h
            ends.append(load.volume(s))
            s.d.flat[j] -= h
        assert f[j] == pytest.approx((ends[0] - ends[1]) / 2e-6, abs=1e-8)


def solved(step: Step, at: Any = X) -> State:
    step.dt, step.count = 1.0, 1
    step.newton = NewtonOptions(dtol=1e-10, etol=0.0, min_residual=1e-26, max_reforms=100)
    result = run(Problem(at, [scenes.block("hex8", CONN, NeoHookean(E=2.0, v=0.2))], [step]))
    assert result.converged, result.reason
    return result.state


def test_a_block_slides_along_a_slope() -> None:
    """Nodes on an oblique plane stay in it; along it nothing holds them."""
    turn = np.array([[0.8, 0.0, 0.6], [0.0, 1.0, 0.0], [-0.6, 0.0, 0.8]])
    at = X @ turn.T
    low, top = np.flatnonzero(X[:, 2] < 0.1), np.flatnonzero(X[:, 2] > 0.9)
    facet = (np.array([[low[0], low[2], low[3], low[1]]]),)
    plane = HeldNormals.of(facet, low, low, LAYOUT.displacement, penalty=100.0, tolerance=1e-10, laugon=1)
    hold = [Fixed(1, np.arange(len(X))), Prescribed(0, top, Constant(0.08)), Prescribed(2, top, Constant(-0.06))]
    s = solved(Step(loads=[plane], conditions=hold), at)
    u = s.u @ turn
    np.testing.assert_array_equal(solved(Step(loads=[plane], conditions=hold), at).u, s.u)  # a run begins anew
    np.testing.assert_allclose(u[low, 2], 0.0, atol=1e-9)
    # along the slope it moves as a whole: the ends are pushed by 0.08 * 0.8 + 0.06 * 0.6
    np.testing.assert_allclose(u[low, 0], 0.1, atol=1e-6)


def test_two_nodes_are_held_at_a_distance() -> None:
    """A free node hangs on a link of fixed length: the link carries the load, whatever its direction."""
    at = np.vstack([X, [0.0, 0.0, 3.0]])
    link = NodeDistance(np.array([6 + 2, 12]), 50.0, 0.25, laugon=True, tolerance=1e-10, maxaug=100)
    pull = NodalForce(np.array([12]), at[12:], value=(0.0, 0.0, 0.3))
    low = np.flatnonzero(at[:, 2] < 0.1)
    aside = [Fixed(k, np.array([12])) for k in (0, 1)]
    s = solved(Step(loads=[link, pull], conditions=[*(Fixed(k, low) for k in range(3)), *aside]), at)
    before, now = at[12] - at[8], s.x[12] - s.x[8]
    assert np.linalg.norm(now) == pytest.approx(np.linalg.norm(before) + 0.25, rel=1e-8)
    assert link.multiplier == pytest.approx(0.3 / (now[2] / np.linalg.norm(now)), rel=1e-6)


@pytest.mark.parametrize("laugon", [False, True])
def test_an_enclosed_volume_is_kept(laugon: bool) -> None:
    """Pressed by a tenth, a block keeps nearly its volume by a penalty, all of it with multipliers."""
    low, top = np.flatnonzero(X[:, 2] < 0.1), np.flatnonzero(X[:, 2] > 0.9)
    load = volume(penalty=-1.0, laugon=laugon, tolerance=1e-9)
    sides = [Fixed(k, np.flatnonzero(X[:, k] < 0.1)) for k in (0, 1)]
    s = solved(Step(loads=[load], conditions=[*sides, Fixed(2, low), Prescribed(2, top, Constant(-0.1))]))
    V = load.volume(s)
    free = solved(Step(conditions=[*sides, Fixed(2, low), Prescribed(2, top, Constant(-0.1))]))
    assert load.start == pytest.approx(1.0) and load.volume(free) < 0.95
    if laugon:
        assert abs(V - 1.0) < 1e-8 and load.multiplier > 0.0
    else:
        assert load.volume(free) + 0.005 < V < 0.99


def test_a_failed_step_gives_multipliers_back() -> None:
    for load in (volume(penalty=-1.0, laugon=True, tolerance=0.1), LOADS["distance"]()):
        load.begin(state(), [])
        kept = load.snapshot()
        load.augment(0, state(0.3))
        assert load.multiplier != 0.0
        load.restore(kept)
        assert load.multiplier == 0.0
