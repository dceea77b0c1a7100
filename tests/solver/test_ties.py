"""Unknowns that depend on others, springs and constraints by penalty."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver.fields import DISPLACEMENT, Layout
from febkit.solver.group import Group
from febkit.solver.loads import azimuth, springs
from febkit.solver.loads.nodal import NodalForce
from febkit.solver.problem import Fixed, NewtonOptions, Problem, Step
from febkit.solver.run import run
from febkit.solver.schedule import Schedule
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.state import State
from febkit.solver.system import System
from febkit.solver.threads import Team
from febkit.solver.ties import LinearConstraint
from helpers import blocks, scenes

RNG = np.random.default_rng(8)


def cube(**step: Any) -> Problem:
    X, conn = scenes.grid((1, 1, 2))
    return Problem(X, [scenes.block("hex8", conn, NeoHookean(E=2.0, v=0.3))], [Step(**step)])


def system(problem: Problem) -> System:
    state = State.at_rest(problem)
    groups = [Group(b, problem.X, 64) for b in problem.blocks]
    s = System(problem, problem.steps[0], groups, state, Schedule(groups, Team(1)))
    state.time = state.dt = 0.5
    return s


def measured(s: System) -> np.ndarray:
    n, base, zero = s.eqs.n, s.gather(s.state.d), np.zeros(s.eqs.n)

    def residual(u: np.ndarray) -> np.ndarray:
        s.set(base, zero, u, s.targets(s.state.time))
        return s.residual()

    out = np.zeros((n, n))
    for k in range(n):
        u = zero.copy()
        u[k] = 1e-6
        out[:, k] = -(residual(u) - residual(-u)) / 2e-6
    residual(zero)
    return out


@pytest.mark.parametrize("symmetric", [True, None])
def test_tangent_of_constraints(symmetric: bool | None) -> None:
    """Chains of masters of one and several elements, across components, one without."""
    ties = [
        LinearConstraint(2, 0, np.array([5, 8, 11]), np.array([0, 1, 2]), (0.5, -0.3, 2.0)),
        LinearConstraint(3, 2, np.array([5]), np.array([2]), (1.0,), offset=0.05),
    ]
    s = system(cube(constraints=ties))
    if symmetric is None:
        s.symmetric = False
    rng = np.random.default_rng(3)
    s.set(s.gather(s.state.d), np.zeros(s.eqs.n), 0.05 * rng.normal(size=s.eqs.n), s.targets(0.5))
    d = s.state.d
    assert d[2, 0] == pytest.approx(0.5 * d[5, 0] - 0.3 * d[8, 1] + 2.0 * d[11, 2])
    assert d[3, 2] == pytest.approx(d[5, 2] + 0.05)
    assert s.eqs.eq[2, 0] == s.eqs.eq[3, 2] == -1 and s.eqs.n == 34
    exact = measured(s)
    np.testing.assert_allclose(blocks.assembled(s), exact, atol=1e-7)


def test_a_constraint_makes_a_face_move_as_one() -> None:
    """Pulled at one corner, the face tied to that corner stays flat; the force is the face's."""
    X = scenes.grid((1, 1, 2))[0]
    low, top = np.flatnonzero(X[:, 2] < 0.1), np.flatnonzero(X[:, 2] > 0.9)
    ties = [LinearConstraint(int(n), 2, top[:1], np.array([2]), (1.0,)) for n in top[1:]]
    pull = NodalForce(top[:1], X[top[:1]], value=(0.0, 0.0, 0.2))
    held = [Fixed(k, low) for k in range(3)]
    options = NewtonOptions(dtol=1e-8, etol=0.0)
    result = run(cube(constraints=ties, conditions=held, loads=[pull], dt=1.0, count=1, newton=options))
    assert result.converged, result.reason
    u = result.state.u[top, 2]
    assert np.ptp(u) == 0.0 and u[0] > 0.05
    assert result.state.reaction[top, 2].sum() == pytest.approx(0.2)
    assert np.abs(result.state.reaction[top, 2]).min() > 0.04


CURVE = lambda s: s + 0.5 * s**2  # noqa: E731
PAIRS = np.array([[0, 3], [1, 2], [4, 0]])
LAWS: dict[str, tuple[Any, dict[str, Any]]] = {
    "linear": (springs.LinearSprings, {"E": 2.0}),
    "in tension": (springs.LinearSprings, {"E": 2.0, "tension_only": True}),
    "by elongation": (springs.NonlinearSprings, {"force": CURVE, "scale": 2.0}),
    "by strain": (springs.NonlinearSprings, {"force": CURVE, "measure": "strain"}),
    "by stretch": (springs.NonlinearSprings, {"force": CURVE, "measure": "stretch"}),
    "experimental": (springs.ExperimentalSprings, {"E": 2.0, "sM": 1.3, "sm": 0.7}),
    "torsion": (springs.TorsionSprings, {"r": 1.5}),
    "muscle": (
        springs.HillMuscles,
        {"ac": 0.6, "Fmax": 5.0, "Ksh": 2.0, "Vmax": 3.0, "Ftl": lambda s: 1 - (s - 1) ** 2, "Fvl": lambda v: 1 + v},
    ),
}


def moved(X: np.ndarray) -> State:
    zero = [np.zeros_like(X) for _ in range(5)]
    u, u_old = 0.2 * RNG.normal(size=X.shape), 0.1 * RNG.normal(size=X.shape)
    return State(Layout([DISPLACEMENT]), X, u, u_old, *zero, time=1.0, dt=0.4)


def forces(load: Any, s: State) -> np.ndarray:
    R = np.zeros_like(s.d)
    load.residual(s, R)
    return R


def differences(s: State, value: Any) -> np.ndarray:
    """Minus the derivatives of a value (k,) by the displacements (k, n)."""
    out = []
    for k in range(s.d.size):
        parts = []
        for h in (1e-6, -1e-6):
            s.d.flat[k] += h
            parts.append(value())
            s.d.flat[k] -= h
        out.append(-(parts[0] - parts[1]) / 2e-6)
    return np.array(out).T


def check_tangent(load: Any, s: State) -> np.ndarray:
    got = np.zeros((s.d.size, s.d.size))
    for K, nodes, columns in load.stiffness(s):
        for k, n in zip(K, nodes, strict=True):
            got[np.ix_(n * 3 + columns, n * 3 + columns)] += k
    exact = differences(s, lambda: forces(load, s).ravel())
    np.testing.assert_allclose(got, exact, atol=1e-6)
    assert np.abs(exact).max() > 0.1
    if load.symmetric:
        np.testing.assert_allclose(got, got.T, atol=1e-12)
    return got


@pytest.mark.parametrize("name", [*LAWS, "composite"])
def test_springs(name: str) -> None:
    """They neither push nor turn the whole, and are as their energy and tangent say."""
    X = RNG.normal(size=(5, 3))
    rest = np.linalg.norm(X[PAIRS[:, 1]] - X[PAIRS[:, 0]], axis=1)
    if name == "composite":
        parts = tuple(LAWS[k][0](PAIRS, rest, **LAWS[k][1]) for k in ("linear", "experimental", "torsion"))
        load: springs.Springs = springs.CompositeSprings(PAIRS, rest, parts=parts)
    else:
        load = LAWS[name][0](PAIRS, rest, **LAWS[name][1])
    s = moved(X)
    R = forces(load, s)
    np.testing.assert_allclose(R.sum(axis=0), 0.0, atol=1e-13)
    if name not in ("torsion", "composite"):  # those keep their direction in space
        np.testing.assert_allclose(np.cross(s.x, R).sum(axis=0), 0.0, atol=1e-13)
    check_tangent(load, s)
    assert sorted(load.joins) == [0, 1, 2, 3, 4]
    if load.energies(s).any():
        np.testing.assert_allclose(differences(s, lambda: load.energies(s).sum()), R.ravel(), atol=1e-8)
    else:
        assert name in ("by elongation", "by strain", "by stretch", "muscle")


def test_an_azimuth_is_held_by_its_multipliers() -> None:
    X = np.vstack([RNG.normal(size=(3, 3)), [(1.0, 2.0, 3.0)]])
    s, load = moved(X), azimuth.Azimuth(np.array([0, 2, 3]), penalty=2.0, laugon=True)
    R = forces(load, s)
    assert not R[1].any() and not R[:, 2].any() and abs(R).max() > 0.01
    np.testing.assert_allclose((R * s.x)[:, :2].sum(axis=1), 0.0, atol=1e-13)  # no force along the radius
    assert not load.augment(0, s) and load.multipliers.any()
    check_tangent(load, s)
    s.d[:] = 0.3 * X
    load.begin(s, [])
    np.testing.assert_allclose(forces(load, s), 0.0, atol=1e-13)


def test_a_node_on_springs_alone_finds_its_place() -> None:
    """Two springs of stiffness 1 and 3 hold a node that belongs to no element."""
    X, conn = scenes.grid((1, 1, 1))
    X = np.vstack([X, [(0.0, 0.0, 3.0), (0.0, 0.0, 6.0)]])
    up, down = (springs.LinearSprings(np.array([p]), np.array([1.0]), E=E) for p, E in (((1, 8), 1.0), ((8, 9), 3.0)))
    held = [Fixed(k, np.array([*range(8), 9])) for k in range(3)]
    block = scenes.block("hex8", conn, NeoHookean(E=2.0, v=0.3))
    options = NewtonOptions(method="full Newton", updates=0, dtol=1e-9, etol=0.0)
    step = Step(loads=[up, down], conditions=[*held, Fixed(0, np.array([8])), Fixed(1, np.array([8]))], dt=1.0, count=1,
                newton=options)  # fmt: skip
    result = run(Problem(X, [block], [step]))
    assert result.converged, result.reason
    assert result.state.d[8, 2] == pytest.approx(4.25 - 3.0)  # z - 2 = 3 (5 - z)


def test_a_set_of_constraints_settles_by_its_multipliers() -> None:
    X = scenes.grid((1, 1, 2))[0]
    low, top = np.flatnonzero(X[:, 2] < 0.1), np.flatnonzero(X[:, 2] > 0.9)
    pairs = np.array([[top[0], n] for n in top[1:]])
    a = np.tile([1.0, -1.0], (3, 1))
    flat = springs.ConstraintSet(pairs, np.full((3, 2), 2), a, penalty=5.0, tolerance=1e-8)
    pull = NodalForce(top[:1], X[top[:1]], value=(0.0, 0.0, 0.2))
    held = [Fixed(k, low) for k in range(3)]
    options = NewtonOptions(method="full Newton", updates=0, dtol=1e-8, etol=0.0, min_residual=1e-26)
    problem = cube(loads=[flat, pull], conditions=held, dt=1.0, count=1, newton=options)
    result = run(problem)
    assert result.converged, result.reason
    assert np.ptp(result.state.u[top, 2]) < 1e-6 < 0.05 < result.state.u[top[0], 2]
    again = run(problem)  # nothing is kept from run to run
    np.testing.assert_array_equal(again.state.d, result.state.d)
