"""Loads: resultants, and tangents against finite differences of the forces."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import elements, loads
from febkit.solver.fields import DISPLACEMENT, PRESSURE, Layout
from febkit.solver.group import Group
from febkit.solver.loads.base import Patch, patches
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.physics import default
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import Block
from febkit.solver.solids.inert import Inert
from febkit.solver.state import State
from febkit.solver.values import Constant, Expression, Map

RNG = np.random.default_rng(3)
FACETS = elements.FACETS
DT = 0.3


def at(X: np.ndarray, columns: int = 3, **kw: Any) -> State:
    """A nodal state at rest, with 3 columns, or 4 where there is a fluid pressure."""
    layout, zero = Layout([DISPLACEMENT, PRESSURE][: columns - 2]), lambda k: np.zeros((len(X), k))
    s = State(layout, X, zero(columns), zero(columns), *(zero(3) for _ in range(5)))
    for name, value in kw.items():
        setattr(s, name, value)
    return s


def state(X: np.ndarray, columns: int = 4, **kw: Any) -> State:
    """A nodal state moved by a fixed random motion."""
    s = at(X, columns, time=1.0, dt=DT, **kw)
    s.u[:] = 0.08 * RNG.normal(size=X.shape)
    if s.p is not None:
        s.p[:] = RNG.uniform(0.5, 1.5, len(X))
    follow(s)
    return s


def follow(s: State) -> None:
    s.velocity = s.u / DT


def facet(kind: str) -> tuple[np.ndarray, tuple[Patch, ...]]:
    """Two facets of one type, bent, that share no nodes."""
    e = elements.get(kind)
    flat = np.column_stack([e.natural, 0.1 * e.natural[:, 0] * e.natural[:, 1]])
    turn = np.linalg.qr(RNG.normal(size=(3, 3)))[0]
    X = np.vstack([flat @ turn.T, flat @ turn.T + [3.0, 1.0, 0.5]])
    return X, patches({kind: np.arange(2 * e.nodes).reshape(2, -1)}, X)


def forces(load: Any, s: State, *groups: Any) -> np.ndarray:
    R = np.zeros_like(s.d)
    load.residual(s, *groups, R)
    return R


def assembled(load: Any, s: State, groups: Any = None) -> np.ndarray:
    n, c = s.d.shape
    out = np.zeros((n * c, n * c))
    for K, nodes, columns in load.stiffness(s, groups):
        for k, rows in zip(K, nodes, strict=True):
            dofs = rows * c + columns
            out[np.ix_(dofs, dofs)] += k
    return out


def measured(load: Any, s: State, update: Any = None, groups: tuple = ()) -> np.ndarray:
    """-dR/dd by central differences."""
    n, c = s.d.shape
    out, h = np.zeros((n * c, n * c)), 1e-6
    for k in range(n * c):
        parts = []
        for sign in (1, -1):
            s.d.flat[k] += sign * h
            follow(s)
            if update:
                update()
            parts.append(forces(load, s, *groups).ravel())
            s.d.flat[k] -= sign * h
        out[:, k] = -(parts[0] - parts[1]) / (2 * h)
    follow(s)
    if update:
        update()
    return out


VARYING = Expression(lambda X, Y, Z, t: 1.0 + 0.3 * X - 0.2 * Z + 0.1 * t)


CASES = {
    "pressure": {"pressure": VARYING, "symmetric_stiffness": False},
    "normal_traction": {"traction": VARYING},
    "effective": {"traction": 0.4, "effective": True},
    "fluidflux": {"flux": VARYING},
    "mixture": {"flux": 0.7, "mixture": True},
    "mixture per reference area": {"flux": 0.7, "mixture": True, "linear": True},
    "pressure Robin BC": {"spring_eps": VARYING, "dashpot_eps": 0.2},
    "traction Robin BC": {"spring_eps": VARYING, "dashpot_eps": 0.2},
}
TYPES = {"effective": "normal_traction", "mixture": "fluidflux", "mixture per reference area": "fluidflux"}


@pytest.mark.parametrize("kind", FACETS)
@pytest.mark.parametrize("case", CASES)
def test_tangent_by_finite_difference(case: str, kind: str) -> None:
    X, surface = facet(kind)
    s = state(X)
    load = loads.load(TYPES.get(case, case))(surface, **CASES[case])
    got, exact = assembled(load, s), measured(load, s)
    np.testing.assert_allclose(got, exact, atol=2e-8)
    assert np.abs(exact).max() > 1e-3
    assert not load.symmetric


@pytest.mark.parametrize("name", ["pressure", "traction", "normal_traction", "fluidflux"])
def test_linear_loads_keep_to_the_reference(name: str) -> None:
    X, surface = facet("quad8")
    value = {"pressure": 1.0, "traction": (1.0, 2.0, 3.0), "normal_traction": 1.0, "fluidflux": 1.0}[name]
    field = {"fluidflux": "flux", "normal_traction": "traction"}.get(name, name)
    load = loads.load(name)(surface, **{field: value}, linear=True)
    a, b = state(X), state(X)
    np.testing.assert_array_equal(forces(load, a), forces(load, b))
    assert load.stiffness(a) == [] and load.cliques() == [] and load.symmetric


def cube(kind: str) -> tuple[np.ndarray, dict[str, np.ndarray], elements.Element]:
    """All facets of one element moved to random nodes."""
    e = elements.get(kind)
    facets: dict[str, list] = {}
    for f, loop in e.facets:
        facets.setdefault(f, []).append(loop)
    return e.natural.copy(), {k: np.array(v) for k, v in facets.items()}, e


@pytest.mark.parametrize("kind", ["hex8", "tet4", "penta6", "tet10", "hex20", "hex27"])
def test_a_closed_surface_under_uniform_pressure(kind: str) -> None:
    """No resultant, and the tangent is its symmetric part."""
    X, facets, _ = cube(kind)
    s = state(X, 3)
    p = loads.load("pressure")(patches(facets, X), pressure=2.0)
    R = forces(p, s)
    np.testing.assert_allclose(R.sum(axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.cross(s.x, R).sum(axis=0), 0.0, atol=1e-12)
    plain = loads.load("pressure")(patches(facets, X), pressure=2.0, symmetric_stiffness=False)
    exact = assembled(plain, s)
    np.testing.assert_allclose(assembled(p, s), exact, atol=1e-12)
    np.testing.assert_allclose(exact, exact.T, atol=1e-12)


def test_pressure_pushes_against_the_normal() -> None:
    X = np.array([(0, 0, 0), (2, 0, 0), (2, 3, 0), (0, 3, 0)], dtype=float)
    s = at(X)
    surface = patches({"quad4": np.arange(4)[None]}, X)
    R = forces(loads.load("pressure")(surface, pressure=5.0), s)
    np.testing.assert_allclose(R, [[0, 0, -7.5]] * 4)
    R = forces(loads.load("traction")(surface, traction=(1.0, 0.0, 2.0), scale=0.5), s)
    np.testing.assert_allclose(R, [[0.75, 0, 1.5]] * 4)
    R = forces(loads.load("force")(surface, force=(4.0, 0.0, 0.0)), s)
    np.testing.assert_allclose(R, [[1.0, 0, 0]] * 4)
    R = forces(loads.load("normal_traction")(surface, traction=Map(np.array([3.0]))), s)
    np.testing.assert_allclose(R, [[0, 0, 4.5]] * 4)


def test_fluid_flux_is_area_times_flux_times_step() -> None:
    X = np.array([(0, 0, 0), (2, 0, 0), (0, 3, 0)], dtype=float)
    s = at(X, 4, dt=0.1)
    R = forces(loads.load("fluidflux")(patches({"tri3": np.arange(3)[None]}, X), flux=2.0), s)
    np.testing.assert_allclose(R[:, 3], 0.2)


def test_effective_traction_subtracts_the_fluid_pressure() -> None:
    X, surface = facet("quad4")
    s = state(X)
    s.d[:, 3] = 0.25
    R = forces(loads.load("normal_traction")(surface, traction=1.0, effective=True), s)
    total = forces(loads.load("normal_traction")(surface, traction=0.75), s)
    np.testing.assert_allclose(R, total, atol=1e-14)


@pytest.mark.parametrize("profile", [0, 1])
def test_bearing_load_adds_up_to_its_force(profile: int) -> None:
    """On a fine cylinder turned at random the resultant is the part of the force across the axis."""
    n, m = 400, 4
    angle, z = np.meshgrid(2 * np.pi * np.arange(n) / n, np.linspace(0, 2, m), indexing="ij")
    X = np.column_stack([np.cos(angle).ravel(), np.sin(angle).ravel(), z.ravel()])
    i, j = np.meshgrid(np.arange(n), np.arange(m - 1), indexing="ij")
    a, b = i.ravel() * m + j.ravel(), (i.ravel() + 1) % n * m + j.ravel()
    turn = np.linalg.qr(RNG.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    X = X @ turn.T
    force = turn @ np.array([3.0, -4.0, 0.5])
    surface = patches({"quad4": np.column_stack([a, b, b + 1, a + 1])}, X)
    load = loads.load("bearing load")(surface, force=tuple(force), scale=2.0, profile=profile)
    s = at(X)
    got = forces(load, s).sum(axis=0)
    expected = 2.0 * np.linalg.norm(force) * turn @ np.array([0.6, -0.8, 0.0])
    np.testing.assert_allclose(got, expected, rtol=1e-3, atol=1e-3)


def test_bearing_load_needs_a_cylinder() -> None:
    points = RNG.normal(size=(60, 3))
    ball = points / np.linalg.norm(points, axis=1)[:, None]
    from febkit.solver.loads.bearing import cylinder_axis

    with pytest.raises(ValueError, match="cylinder"):
        cylinder_axis(ball)


def test_nodal_loads() -> None:
    X = RNG.normal(size=(5, 3))
    s, nodes = state(X), np.array([1, 3])
    value = (1.0, 2.0, Map(np.array([3.0, 4.0])))
    R = forces(loads.load("nodal_force")(nodes, X[nodes], value=value), s)
    np.testing.assert_allclose(R[nodes, :3], [[1, 2, 3], [1, 2, 4]])
    assert not R[[0, 2, 4]].any()
    R = forces(loads.load("nodal_load")(nodes, X[nodes], dof="y", scale=2.0), s)
    np.testing.assert_allclose(R[nodes], [[0, 2, 0, 0]] * 2)
    R = forces(loads.load("nodal fluidflux")(nodes, X[nodes], value=2.0), s)
    np.testing.assert_allclose(R[nodes, 3], 2.0 * DT)


def test_relative_and_target_nodal_loads() -> None:
    X = RNG.normal(size=(4, 3))
    s, nodes = state(X, reaction=np.full((4, 3), 6.0)), np.array([0, 2])
    relative = loads.load("nodal_force")(nodes, X[nodes], value=(1.0, 0.0, 0.0), relative=True)
    relative.begin_step(s)
    np.testing.assert_allclose(forces(relative, s)[nodes, :3], [[7, 6, 6]] * 2)
    target = loads.load("nodal_target_force")(nodes, X[nodes], force=(2.0, 2.0, 2.0), scale=0.25)
    target.begin_step(s)
    s.reaction[:] = 9.0
    target.begin_step(s)  # a later step: the start stays
    np.testing.assert_allclose(forces(target, s)[nodes, :3], 0.75 * 6 + 0.25 * 2)


# ---- body loads ---------------------------------------------------------------------------------------
def group(kind: str, s: State, physics: Any = None) -> tuple[Group, Any]:
    """One element, deformed as the state has it."""
    conn = np.arange(elements.get(kind).nodes)[None]
    block = Block("part", kind, conn, np.array([1]), Inert(density_=2.0), physics or default())
    block.rule = "G4" if kind == "tet4" else None
    g = Group(block, s.X)

    def update() -> None:
        g.deform(s.u, g.F, g.J)

    update()
    return g, update


MIXTURE = Biphasic(ConstIso(1.0), Constant(0.3), Constant(0.9))
BODY = {
    "centrifugal": {
        "angular_speed": 1.3, "rotation_axis": (0.0, 0.6, 0.8), "rotation_center": (0.1, 0.0, 0.0),
    },
    "mass damping": {"C": VARYING},
    "moving frame": {"wx": 0.7, "wy": -0.4, "wz": 1.1, "ax": 0.3},
    "moving frame, of its own": {"wx": 0.7, "wy": -0.4, "wz": 1.1, "az": 0.3, "moving": True},
    "body force": {"given": (1.0, VARYING, -2.0)},
}


@pytest.mark.parametrize("mixture", [None, MIXTURE], ids=["solid", "biphasic"])
@pytest.mark.parametrize("kind", ["hex8", "tet4"])
@pytest.mark.parametrize("name", BODY)
def test_body_tangent_by_finite_difference(name: str, kind: str, mixture: Any) -> None:
    s = state(elements.get(kind).natural.copy(), 3)
    g, update = group(kind, s, mixture)
    load = loads.load(name.partition(",")[0])(**BODY[name])
    load.rate = 1.0  # of backward Euler, as are the velocities
    if hasattr(load, "begin_step"):
        load.begin_step(s)
    exact = measured(load, s, update, ([g],))
    np.testing.assert_allclose(assembled(load, s, [g]), exact, atol=1e-7)


def test_a_frame_that_turns_steadily_pulls_outwards() -> None:
    """In the second step, and again where the step is tried again, its angular velocity no longer changes."""
    s = state(elements.get("hex8").natural.copy(), 3)
    s.velocity[:] = 0.0
    frame, pull = loads.load("moving frame")(wz=1.3), loads.load("centrifugal")(angular_speed=1.3)
    for s.time, again in ((DT, False), (2 * DT, False), (2 * DT, True)):
        frame.begin_step(s)
        g, _ = group("hex8", s)
        same = np.allclose(forces(frame, s, [g]), forces(pull, s, [g]))
        assert same == (s.time > DT), again


def test_weight() -> None:
    """FEBio's body force acts against its own direction; mixtures weigh phi0 rho_s + (J - phi0) rho_w."""
    s = state(elements.get("hex8").natural.copy(), 3)
    s.d[:] = 0.1 * s.X
    follow(s)
    load = loads.load("const")(z=10.0)
    g, _ = group("hex8", s)
    np.testing.assert_allclose(forces(load, s, [g]).sum(axis=0), [0, 0, -8 * 2 * 10], atol=1e-12)
    g, _ = group("hex8", s, MIXTURE)
    weight = 8 * 10 * (0.3 * 2.0 + (1.1**3 - 0.3) * 0.9)
    np.testing.assert_allclose(forces(load, s, [g]).sum(axis=0), [0, 0, -weight], atol=1e-12)


def test_body_load_on_part_of_a_block() -> None:
    s = state(elements.get("hex8").natural.copy(), 3)
    g, _ = group("hex8", s)
    assert not forces(loads.load("const")(x=1.0, blocks=("other",)), s, [g]).any()
    assert not forces(loads.load("const")(x=1.0, elements={"part": np.array([], dtype=int)}), s, [g]).any()
