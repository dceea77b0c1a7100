"""Body loads in dynamics: their tangents with the time integration, and motions with known answers."""

from __future__ import annotations

from math import exp
from typing import Any

import numpy as np
import pytest

from febkit.solver import loads
from febkit.solver.group import Group
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import DYNAMIC, STATIC, TRANSIENT, Fixed, Initial, Problem, Step
from febkit.solver.run import run
from febkit.solver.schedule import Schedule
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.state import State
from febkit.solver.system import System
from febkit.solver.threads import Team
from febkit.solver.values import Constant, Scaled
from helpers import scenes
from helpers.scenes import UX, UZ

RNG = np.random.default_rng(11)
DT = 0.2
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "mass damping": ("mass damping", {"C": 0.7}),
    "centrifugal": ("centrifugal", {"angular_speed": 1.3, "rotation_axis": (0.0, 0.6, 0.8)}),
    "frame": ("moving frame", {"wx": 0.7, "wy": -0.4, "wz": 1.1, "ax": 0.3}),
    "frame, of its own": ("moving frame", {"wx": 0.7, "wy": -0.4, "wz": 1.1, "ax": 0.3, "moving": True}),
}
NEWMARK = [  # rho_inf, beta, gamma; -2 takes beta and gamma as they are given
    (-2.0, 0.25, 0.5), (-2.0, 0.4, 0.8), (-1.0, 0.25, 0.5), (0.0, 0.25, 0.5), (0.5, 0.25, 0.5),
]  # fmt: skip


def system(load: Any, analysis: str, options: dict[str, float] | None = None) -> System:
    """Two elements in motion in the middle of a step; ``load`` alone acts on them, if any."""
    X, conn = scenes.box("hex8", (1, 1, 2))
    mixture = Biphasic(ConstIso(0.3), Constant(0.2), Constant(0.9)) if analysis == TRANSIENT else None
    step = Step(analysis=analysis, newton=scenes.tight(**(options or {})), body_loads=[] if load is None else [load])
    base = np.flatnonzero(X[:, 2] < 1e-9)
    step.conditions = [Fixed(c, base) for c in range(UX, UZ + 1)]
    problem = Problem(X, [scenes.block("hex8", conn, NeoHookean(2.0, 0.3, density_=1.7), mixture)], [step])
    state, groups = State.at_rest(problem), [Group(b, X) for b in problem.blocks]
    out = System(problem, step, groups, state, Schedule(groups, Team(1)))
    rng = np.random.default_rng(5)
    moving = 0.05 * rng.normal(size=X.shape) * (X[:, 2] > 0)[:, None]
    state.d[:, :3] = moving
    state.d_old = state.d.copy()
    state.velocity_old = 0.3 * rng.normal(size=X.shape)
    state.acceleration_old = 0.2 * rng.normal(size=X.shape)
    state.velocity, state.acceleration = state.velocity_old.copy(), state.acceleration_old.copy()
    state.time, state.dt = DT, DT
    for b in out.body_loads:
        if hasattr(b, "begin_step"):
            b.begin_step(state)
    for g in groups:
        g.begin_step(state)
    return out


def forces(s: System, u: np.ndarray) -> np.ndarray:
    """Residual of the free unknowns at a displacement by ``u`` (rows) of the step so far."""
    total, move = s.gather(s.state.d_old), np.zeros(s.eqs.n)
    move[s.eqs.rows] = u
    s.set(total, np.zeros(s.eqs.n), move, s.state.d_old)
    return s.residual()[s.eqs.rows]


def dense(s: System) -> np.ndarray:
    A = s.tangent(np.zeros(s.eqs.n))[0]
    full = np.zeros((A.n, A.n))
    row = np.repeat(np.arange(A.n), np.diff(A.indptr))
    full[row, A.indices] = A.data
    return full + np.triu(full, 1).T if A.symmetric else full


def check_tangent(load: Any, analysis: str, options: dict[str, float] | None = None) -> np.ndarray:
    """The load's share of the tangent is minus the derivative of its share of the residual."""
    s, bare = system(load, analysis, options), system(None, analysis, options)
    bare.step.newton.symmetric = None
    n, h = len(s.eqs.rows), 1e-5
    at = 0.02 * RNG.normal(size=n)
    forces(s, at), forces(bare, at)
    share = dense(s) - dense(bare)
    for k in range(n):
        du = h * (np.arange(n) == k)
        slope = [(forces(q, at + du) - forces(q, at - du)) / (2 * h) for q in (s, bare)]
        np.testing.assert_allclose(share[:, k], slope[1] - slope[0], atol=2e-8)
    return share


@pytest.mark.parametrize("newmark", NEWMARK, ids=str)
@pytest.mark.parametrize("case", CASES)
def test_tangents_follow_the_time_integration(case: str, newmark: tuple[float, float, float]) -> None:
    name, parameters = CASES[case]
    options = dict(zip(("rho_inf", "beta", "gamma"), newmark, strict=True))
    if newmark[0] == -2.0:
        options["alpha"] = 0.8
    assert np.abs(check_tangent(loads.load(name)(**parameters), DYNAMIC, options)).max() > 1e-3


def test_tangents_of_transient_mixtures_and_of_statics() -> None:
    """Velocities are those of backward Euler there, and none here."""
    assert np.abs(check_tangent(loads.load("mass damping")(C=0.7), TRANSIENT)).max() > 1e-3
    assert not check_tangent(loads.load("mass damping")(C=0.7), STATIC).any()
    assert np.abs(check_tangent(loads.load("centrifugal")(angular_speed=1.3), STATIC)).max() > 1e-3


def free_block(count: int, end: float, body: Any, velocity: tuple[float, float, float], **newton: float) -> Any:
    """Where nodes are, in the end, of a stiff block that nothing holds: a velocity to start with, a body load."""
    X, conn = scenes.grid((1, 1, 1), (0.1, 0.1, 0.1))
    nodes = np.arange(len(X))
    step = Step(analysis=DYNAMIC, dt=end / count, count=count, newton=scenes.tight(**newton), body_loads=[body])
    step.newton.dtol, step.newton.min_residual = 1e-10, 1e-22
    step.initial = [Initial(c, nodes, Constant(v), velocity=True) for c, v in enumerate(velocity)]
    problem = Problem(X, [scenes.block("hex8", conn, NeoHookean(50.0, 0.3, density_=2.0))], [step])
    result = run(problem, options=Options(threads=1, linear="dense"))
    assert result.converged, result.reason
    return X, result.state


def orders(errors: list[float]) -> np.ndarray:
    return -np.diff(np.log2(errors))


@pytest.mark.parametrize("rho", [-2.0, 0.5, 0.0])
def test_a_damped_block_slows_down_exponentially(rho: float) -> None:
    """v = v0 exp(-C t), to second order; forces taken at the step's end instead of within it would leave first."""
    C, v0, end, errors = 0.9, 1.5, 2.0, []
    for count in (5, 10, 20):
        _, s = free_block(count, end, loads.load("mass damping")(C=C), (v0, 0.0, 0.0), rho_inf=rho)
        np.testing.assert_allclose(s.d[:, :3], s.d[:1, :3].repeat(8, axis=0), atol=1e-6)
        errors.append(abs(s.d[:, 0].mean() - v0 * (1 - exp(-C * end)) / C))
    assert errors[-1] < 1e-2 and (orders(errors) > 1.7).all(), errors


def test_a_block_at_rest_turns_back_in_a_frame_that_turns() -> None:
    """Coriolis, Euler and centrifugal forces together: nothing pushes it, so that it stays where it is outside."""
    rate, end, errors = 0.6, 1.0, []
    for count in (10, 20, 40):
        spin = Scaled(Constant(rate), lambda t: t)
        X, s = free_block(count, end, loads.load("moving frame")(wz=spin), (0.0, 0.0, 0.0), rho_inf=-2.0)
        angle = 0.5 * rate * end**2
        c, q = np.cos(angle), np.sin(angle)
        there = X.mean(axis=0) @ np.array([[c, q, 0], [-q, c, 0], [0, 0, 1]]).T
        errors.append(float(np.linalg.norm(s.x.mean(axis=0) - there)))
    assert errors[-1] < 1e-3 and (orders(errors) > 0.8).all(), errors


def test_a_centrifuge_throws_a_block_outwards() -> None:
    """r'' = w^2 r: r = r0 cosh(w t)."""
    w, end, errors = 1.2, 1.0, []
    for count in (10, 20, 40):
        X, s = free_block(count, end, loads.load("centrifugal")(angular_speed=w), (0.0, 0.0, 0.0), rho_inf=0.5)
        there = X.mean(axis=0) * [np.cosh(w * end), np.cosh(w * end), 1.0]
        errors.append(float(np.linalg.norm(s.x.mean(axis=0) - there)))
    assert errors[-1] < 1e-4 and (orders(errors) > 1.7).all(), errors
