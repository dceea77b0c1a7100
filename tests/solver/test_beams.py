"""Beams and trusses: analytic solutions, objectivity, tangents by differences, inertia."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import physics
from febkit.solver.fields import DISPLACEMENT, ROTATION, Layout
from febkit.solver.loads.body_force import BodyForce
from febkit.solver.loads.nodal import NodalDofLoad, NodalForce
from febkit.solver.problem import DYNAMIC, Block, Fixed, Prescribed, Problem, Step
from febkit.solver.quaternions import matrix, of_vector
from febkit.solver.result import Result
from febkit.solver.run import Listener, Run, run
from febkit.solver.solids.inert import Inert
from febkit.solver.solids.mooney_rivlin import MooneyRivlin
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.values import Constant, Expression
from helpers import blocks, scenes

LAYOUT = Layout([DISPLACEMENT, ROTATION])
U = LAYOUT.displacement
W = LAYOUT.columns("rotation")
SECTION: dict[str, float] = dict(E=2e4, G=8e3, A=0.3, A1=0.25, A2=0.2, I1=0.02, I2=0.013, density=1.5)


class Keep(Listener):
    def end(self, run: Run, result: Result) -> None:
        self.run = run


def line(n: int, kind: str, length: float = 3.0, turn: Any = (0.0, 0.0, 0.0)) -> tuple[Any, Any]:
    """Nodes and elements of a straight line, along X unless turned."""
    k = 2 if kind == "line3" else 1
    x = np.linspace(0.0, length, k * n + 1)
    X = np.column_stack([x, 0 * x, 0 * x]) @ matrix(of_vector(np.asarray(turn, float))).T
    first = k * np.arange(n)
    ends = [first, first + k] + ([first + 1] if k == 2 else [])
    return X, np.stack(ends, axis=1)


def beam(X: Any, conn: Any, kind: str, step: Step, **other: float) -> Problem:
    p = physics.load("beam")(**SECTION | other)
    block = Block("beam", kind, conn, np.arange(len(conn)) + 1, Inert(density_=p.density), p, rule="G2")
    return Problem(X, [block], [step])


def clamp(node: int = 0) -> list[Any]:
    return [Fixed(c, np.array([node])) for c in (*U, *W)]


def solved(problem: Problem) -> Run:
    keep = Keep()
    result = run(problem, [keep])
    assert result.converged, result.reason
    return keep.run


@pytest.mark.parametrize("kind", ["line2", "line3"])
@pytest.mark.parametrize("turn", [(0, 0, 0), (0.3, -0.8, 0.4), (0, -np.pi / 2, 0)])
def test_a_cantilever_that_hardly_bends(kind: str, turn: Any) -> None:
    """u = F L^3 / 3 E I + F L / G A with one-point accuracy in the limit of many elements; the axes follow the line."""
    L, n, F = 3.0, 24, 1e-4
    X, conn = line(n, kind, L, turn)
    from febkit.solver.physics.beam import frames

    E1, E2, E3 = frames(((X[-1] - X[0]) / L)[None])[0].T
    p = SECTION
    for load, I, A in ((E1, p["I2"], p["A1"]), (E2, p["I1"], p["A2"])):
        end = NodalForce(np.array([len(X) - 1]), X[-1:], value=tuple(Constant(F * q) for q in load))
        step = Step(dt=1.0, count=1, newton=scenes.tight(dtol=1e-7), conditions=clamp(), loads=[end])
        r = solved(beam(X, conn, kind, step))
        tip = r.state.u[-1]
        exact = F * L**3 / (3 * p["E"] * I) + F * L / (p["G"] * A)
        # two points a linear element see shear of I / L^2: it bends by a factor 1 / (1 + G A h^2 / 12 E I) too little
        stiff = 1.0 + p["G"] * A * (L / n) ** 2 / (12 * p["E"] * I) if kind == "line2" else 1.0
        assert tip @ load == pytest.approx(exact / stiff, rel=2e-3 if kind == "line3" else 2e-2)
        assert abs(tip @ E3) < 1e-6 * abs(tip @ load)


@pytest.mark.parametrize("turn", [(0, 0, 0), (0.3, -0.8, 0.4)])
def test_a_cantilever_rolled_up_by_a_moment(turn: Any) -> None:
    """A moment 2 pi E I / L bends a beam to a circle (Simo and Vu-Quoc 1986, example 7.1)."""
    L, n = 3.0, 10
    X, conn = line(n, "line3", L, turn)
    from febkit.solver.physics.beam import frames

    E1 = frames(((X[-1] - X[0]) / L)[None])[0][:, 0]
    M = 2 * np.pi * SECTION["E"] * SECTION["I1"] / L
    ramp = [Expression(lambda X, Y, Z, t, q=q: q * t + 0 * X) for q in M * E1]
    loads = [NodalDofLoad(np.array([len(X) - 1]), X[-1:], dof=d, scale=v) for d, v in zip("uvw", ramp)]
    step = Step(dt=0.1, count=10, newton=scenes.tight(dtol=1e-9), conditions=clamp(), loads=loads)
    r = solved(beam(X, conn, "line3", step))
    np.testing.assert_allclose(r.state.x[-1], X[0], atol=5e-3)
    w = r.groups[0].physics
    np.testing.assert_allclose(np.linalg.norm(w.k, axis=-1), 2 * np.pi / L, rtol=1e-3)
    np.testing.assert_allclose(w.moment, np.broadcast_to(M * E1, w.moment.shape), rtol=1e-6, atol=1e-4 * M)


@pytest.mark.parametrize("kind", ["line2", "line3"])
def test_a_rigid_motion_makes_no_strain(kind: str) -> None:
    """All nodes turned about one axis by many degrees and moved: no force, no moment."""
    X, conn = line(3, kind, 2.0, (0.3, -0.8, 0.4))
    axis = np.array([0.9, -1.2, 0.6])
    conditions: list[Any] = []
    for i, c in enumerate(U):
        for a in range(len(X)):
            path = Expression(lambda *at, i=i, a=a: (matrix(of_vector(axis * at[3])) @ X[a] - X[a])[i] + 2 * at[3])
            conditions.append(Prescribed(c, np.array([a]), path))
    for q, c in zip(axis, W):
        conditions.append(Prescribed(c, np.arange(len(X)), Expression(lambda X, Y, Z, t, q=q: q * t + 0 * X)))
    r = solved(beam(X, conn, kind, Step(dt=0.25, count=4, newton=scenes.tight(), conditions=conditions)))
    w = r.groups[0].physics
    assert np.abs(w.t).max() < 1e-9 * SECTION["E"] and np.abs(w.moment).max() < 1e-9 * SECTION["E"]
    np.testing.assert_allclose(w.slope[0, 0], matrix(of_vector(axis)) @ (X[-1] - X[0]) / 2.0, atol=1e-12)


def differences(r: Run) -> tuple[Any, Any]:
    """The tangent at the end of a run, and minus the derivative of the residual by increments of the unknowns."""
    system = r.system
    assert system is not None
    system.settle()
    zero = np.zeros(system.eqs.n)
    # the present state as the increment of the step, from which small ones go on
    total = system.gather(r.state.d_old)
    increment = system.gather(r.state.d) - total
    rotations = system.rotations
    if rotations is not None:
        of = np.zeros_like(r.state.d)
        of[:, rotations.own] = r.state.extra["turned"]
        eq = system.eqs.column >= rotations.own.start
        increment[eq] = system.gather(of)[eq]
    target = r.state.d.copy()

    def residual(u: Any) -> Any:
        system.set(total, increment, u, target)
        return system.residual()

    here = residual(zero)
    A = blocks.assembled(system)
    h, K = 1e-6, np.empty_like(A)
    for i, row in enumerate(system.eqs.rows):
        u = zero.copy()
        u[row] = h
        K[:, i] = -(residual(u) - residual(-u))[system.eqs.rows] / (2 * h)
    residual(zero)
    assert np.isfinite(here).all()
    return A, K


def loose(**other: Any) -> Any:
    """A state far from balance: the first iterate is taken."""
    return scenes.tight(dtol=1e9, **other)


@pytest.mark.parametrize("kind", ["line2", "line3"])
@pytest.mark.parametrize("how", [{}, {"rho_inf": 0.4}, {"rho_inf": -1.0}, "static"])
def test_tangent_of_beams(kind: str, how: Any) -> None:
    """Large rotations, in motion, away from balance."""
    X, conn = line(2, kind, 1.5, (0.3, -0.8, 0.4))
    end = np.array([len(X) - 1])
    ramp = [Expression(lambda X, Y, Z, t, q=q: q * t + 0 * X) for q in (30.0, -40.0, 25.0)]
    loads: list[Any] = [NodalDofLoad(end, X[end], dof=d, scale=v) for d, v in zip("uvw", ramp)]
    loads.append(NodalForce(end, X[end], value=(Constant(20.0), Constant(-30.0), Constant(10.0))))
    newton = loose() if how == "static" else loose(**how)
    step = Step(dt=0.05, count=3, newton=newton, conditions=clamp(), loads=loads)
    step.analysis = "static" if how == "static" else DYNAMIC
    r = solved(beam(X, conn, kind, step))
    assert np.abs(r.state.d[:, W]).max() > 0.05
    A, K = differences(r)
    np.testing.assert_allclose(A, K, atol=2e-6 * np.abs(K).max())


class Momenta(Listener):
    """Momentum and angular momentum about the origin after each step."""

    def __init__(self) -> None:
        self.p: list[Any] = []
        self.h: list[Any] = []

    def converged(self, run: Run, counts: Any) -> None:
        g, s = run.groups[0], run.state
        w, x, v = (np.einsum("ga,eai->egi", g.N, a[g.conn]) for a in (s.extra["spin"], s.x, s.velocity))
        m = SECTION["density"] * g.wJ0[..., None]
        spin = g.physics._inertia() @ w[..., None]
        self.p.append((m * v).sum(axis=(0, 1)))
        self.h.append((m * np.cross(x, v) + g.dS[..., None] * spin[..., 0]).sum(axis=(0, 1)))


def test_a_beam_that_spins_keeps_its_momentum() -> None:
    """A free beam after a push of 0.1: its momentum is the push's, its angular momentum stays while it tumbles."""
    X, conn = line(4, "line3", 2.0)
    pulse = Expression(lambda X, Y, Z, t: np.where((t > 0) & (t < 0.105), 1.0, 0.0) + 0 * X)
    loads: list[Any] = [NodalForce(np.array([0]), X[:1], value=(Constant(0.0), pulse, pulse))]
    loads.append(NodalDofLoad(np.array([4]), X[4:5], dof="u", scale=pulse))
    step = Step(analysis=DYNAMIC, dt=0.01, count=100, newton=scenes.tight(dtol=1e-7, min_residual=1e-18), loads=loads)
    watch = Momenta()
    result = run(beam(X, conn, "line3", step), [watch])
    assert result.converged, result.reason
    assert np.abs(result.state.d[:, W]).max() > 0.8
    h = np.array(watch.h)
    np.testing.assert_allclose(watch.p[20:], np.tile([0.0, 0.1, 0.1], (80, 1)), rtol=1e-6, atol=1e-8)
    assert np.linalg.norm(h[20]) > 0.1
    np.testing.assert_allclose(h[20:], np.tile(h[20], (80, 1)), atol=5e-3 * np.linalg.norm(h[20]))


def test_a_push_at_the_start_has_no_accelerations_in_quadratic_beams() -> None:
    """Two integration points leave their mass singular."""
    X, conn = line(2, "line3")
    push = NodalForce(np.array([0]), X[:1], value=(Constant(0.0), Constant(1.0), Constant(0.0)))
    result = run(beam(X, conn, "line3", Step(analysis=DYNAMIC, dt=0.01, count=1, loads=[push])))
    assert not result.converged and "the mass is singular" in result.reason


def test_beams_and_solids_share_nodes() -> None:
    """A cube on a beam: the displacements of the shared node are one."""
    X, hexes = scenes.grid((1, 1, 1))
    X = np.vstack([X, [[0.0, 0.0, -1.0]]])
    p = physics.load("beam")(**SECTION)
    blocks = [
        Block("cube", "hex8", hexes, np.arange(1), NeoHookean(10.0, 0.3)),
        Block("beam", "line2", np.array([[8, 0]]), np.arange(1), Inert(), p, rule="G2"),
    ]
    held = [Fixed(c, np.array([8])) for c in (*U, *W)] + [Fixed(c, np.flatnonzero(X[:, 2] == 1.0)) for c in U[:2]]
    top = np.flatnonzero(X[:, 2] == 1.0)
    held.append(Prescribed(U[2], top, Constant(0.01)))
    step = Step(dt=1.0, count=1, newton=scenes.tight(dtol=1e-10), conditions=held)
    r = solved(Problem(X, blocks, [step]))
    t = r.groups[1].physics.t[0].mean(axis=0)
    np.testing.assert_allclose(r.state.reaction[8], -t, rtol=1e-9)
    assert t[2] > 0 and r.state.layout.fields == (DISPLACEMENT, ROTATION)


# ---- trusses ----------------------------------------------------------------------------------------
def truss(X: Any, conn: Any, step: Step, record: Any, solid: Any) -> Problem:
    return Problem(X, [Block("truss", "line2", conn, np.arange(len(conn)) + 1, solid, record, rule="G2")], [step])


RECORDS = [
    (physics.load("linear truss")(0.4, 100.0, 0.3), Inert(density_=2.0)),
    (physics.load("elastic truss")(0.4, 0.3), NeoHookean(100.0, 0.3)),
    (physics.load("elastic truss")(0.4, 0.4), MooneyRivlin(10.0, 1.0, k=1000.0)),
]
PYRAMID = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.2, 0.9]]), np.array([[0, 3], [1, 3], [3, 2]])


@pytest.mark.parametrize(("record", "solid"), RECORDS)
def test_tangent_of_trusses(record: Any, solid: Any) -> None:
    X, conn = PYRAMID
    held = [Fixed(c, np.arange(3)) for c in range(3)]
    push = NodalForce(np.array([3]), X[3:], value=(Constant(4.0), Constant(-3.0), Constant(6.0)))
    r = solved(truss(X, conn, Step(dt=1.0, count=1, newton=loose(), conditions=held, loads=[push]), record, solid))
    assert np.abs(r.groups[0].physics.stretch - 1.0).max() > 0.05
    A, K = differences(r)
    np.testing.assert_allclose(A, K, atol=1e-7 * np.abs(K).max())


@pytest.mark.parametrize(("record", "solid"), RECORDS)
def test_stretch_of_a_truss(record: Any, solid: Any) -> None:
    """The force along a truss of any direction: E ln(lambda) A0 / lambda, or that of the solid with free sides."""
    d = np.array([2.0, -1.0, 2.0]) / 3.0
    X = np.array([[0.0, 0, 0], 2.0 * d])
    lam = 1.3
    held = [Fixed(c, np.array([0])) for c in range(3)]
    pull = [Prescribed(c, np.array([1]), Constant(2.0 * (lam - 1.0) * d[c])) for c in range(3)]
    step = Step(dt=1.0, count=1, newton=scenes.tight(), conditions=[*held, *pull])
    r = solved(truss(X, np.array([[0, 1]]), step, record, solid))
    if record.name == "linear truss":
        force = 0.4 * 100.0 * np.log(lam) / lam
    elif solid.uncoupled:  # s = 2 (dev b c1 - dev b^-1 c2) / J with free sides, b of the isochoric stretch
        J = lam**0.2
        a, b = lam / J ** (1 / 3), lam**-0.4 / J ** (1 / 3)
        s = 2.0 / J * (10.0 * (a**2 - b**2) - 1.0 * (a**-2 - b**-2))
        force = 0.4 * s * lam**-0.8
    else:
        mu, la, J = 100 / 2.6, 100 * 0.3 / 1.3 / 0.4, lam**0.4
        force = 0.4 * (mu * (lam**2 - 1) + la * np.log(J)) / lam
    np.testing.assert_allclose(r.state.reaction[1], force * d, rtol=1e-12)


def test_a_truss_has_the_weight_and_the_mass_of_its_volume() -> None:
    X, conn = PYRAMID
    held = [Fixed(c, np.arange(4)) for c in range(3)]
    weight = BodyForce(given=(Constant(0.0), Constant(0.0), Constant(9.81)))
    record, solid = RECORDS[0]
    r = solved(truss(X, conn, Step(dt=1.0, count=1, conditions=held, body_loads=[weight]), record, solid))
    R = np.zeros_like(r.state.d)
    weight.residual(r.state, r.groups, R)
    volume = 0.4 * np.linalg.norm(X[conn[:, 1]] - X[conn[:, 0]], axis=1).sum()
    np.testing.assert_allclose(R.sum(axis=0), [0, 0, -2.0 * 9.81 * volume], rtol=1e-12)
