"""Tangents of rigid bodies, what they carry and what joins them, against differences of the residual."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import loads
from febkit.solver.loads.body_force import ComponentForce
from febkit.solver.problem import Fixed, Prescribed
from febkit.solver.rigid import connectors, joints, rotation
from febkit.solver.values import Constant
from helpers import blocks

A, B, ORIGIN = np.array([0.3, 1.0, 2.0]), np.array([4.5, 0.2, 1.5]), np.array([2.0, 1.0, 0.5])
AXES = joints.axes(np.array([1.0, 2.0, 2.0]), np.array([0.0, 1.0, 0.0]))
HELD: dict[str, Any] = dict(origin=ORIGIN, axes=AXES, force_penalty=3.0, moment_penalty=2.0)
CONNECTORS = {
    "spring": connectors.Spring(0, 1, A, B, k=2.0, free_length=1.0),
    "damper": connectors.Damper(0, 1, A, B, c=0.4),
    "angular damper": connectors.AngularDamper(0, 1, c=0.4),
    "contractile force": connectors.ContractileForce(0, 1, A, B, f0=2.0),
    "rigid joint": joints.RigidJoint(0, 1, joint=ORIGIN, penalty=3.0),
    "axial force": connectors.AxialForce(0, 1, A, B, f0=2.0),
    "cable": connectors.Cable(0, 1, A, B, f0=2.0),
    "generic": joints.GenericJoint(0, 1, joint=ORIGIN, penalty=3.0, given=(0.1, None, 0.0, 0.2, 0.0, None)),
    "lock": joints.Lock(0, 1, **HELD),
    "revolute": joints.Revolute(0, 1, **HELD, force_damping=0.2, moment_damping=0.3, applied_moment=1.0),
    "revolute, led": joints.Revolute(0, 1, **HELD, prescribed_rotation=True, rotation=0.7, moment_damping=0.3),
    "prismatic": joints.Prismatic(0, 1, **HELD, force_damping=0.2, moment_damping=0.3, applied_force=1.0),
    "prismatic, led": joints.Prismatic(0, 1, **HELD, prescribed_translation=True, translation=0.7),
    "cylindrical": joints.Cylindrical(0, 1, **HELD, applied_force=1.0, applied_moment=2.0),
    "cylindrical, led": joints.Cylindrical(
        0, 1, **HELD, prescribed_translation=True, translation=0.3, prescribed_rotation=True, rotation=-0.4
    ),
    "planar": joints.Planar(0, 1, **HELD),
    "planar, led along one axis": joints.Planar(0, 1, **HELD, prescribed_translation_1=True, translation_1=0.2),
    "planar, led": joints.Planar(
        0, 1, **HELD, prescribed_translation_1=True, prescribed_translation_2=True, translation_2=0.2,
        prescribed_rotation=True, rotation=0.3,
    ),
    "spherical": joints.Spherical(0, 1, **HELD, moments=(1.0, 2.0, 3.0)),
    "spherical, led": joints.Spherical(0, 1, **HELD, prescribed_rotation=True, rotations=(0.1, 0.4, -0.3)),
}  # fmt: skip


def agree(s: blocks.System, atol: float = 2e-7) -> np.ndarray:
    exact, got = blocks.measured(s), blocks.assembled(s)
    rows = s.eqs.rows
    exact = exact[np.ix_(rows, rows)]
    np.testing.assert_allclose(got, exact, atol=atol * max(1.0, np.abs(exact).max()))
    return exact


@pytest.mark.parametrize("rho", [-2.0, 0.5])
@pytest.mark.parametrize("name", CONNECTORS)
def test_of_connectors(name: str, rho: float) -> None:
    step = dict(connectors=[CONNECTORS[name]])
    s = blocks.system(blocks.two_boxes(**(step if rho < 0 else blocks.dynamic(rho, **step))))
    assert s.bodies is not None
    s.bodies.mass[:], s.bodies.inertia[:] = 0.0, 0.0
    blocks.shaken(s)
    blocks.settle(s)
    blocks.shaken(s, seed=4)
    s.state.extra["multipliers"][:] = 0.5
    exact = agree(s)
    assert np.abs(exact).max() > 1e-3
    R = s.residual().reshape(2, 6)  # what joins two bodies neither pushes nor turns the whole
    x = np.array([b.centre for b in s.bodies.bodies]) + s.state.d[s.bodies.rows]
    np.testing.assert_allclose(R[:, :3].sum(axis=0), 0.0, atol=1e-12)
    if rho < 0 and name in ("spring", "contractile force", "axial force", "generic"):
        np.testing.assert_allclose((np.cross(x, R[:, :3]) + R[:, 3:]).sum(axis=0), 0.0, atol=1e-12)


def test_forces_of_connectors_are_those_of_the_present_state() -> None:
    """What was found for the residual serves the tangent of the same state, and of no other."""
    lock = CONNECTORS["revolute"]
    s = blocks.system(blocks.two_boxes(**blocks.dynamic(0.5, connectors=[lock])))
    blocks.shaken(s)
    acting = s.bodies.connectors if s.bodies is not None else None
    assert acting is not None

    def forces() -> np.ndarray:
        R = np.zeros_like(s.state.d)
        acting.residual(s.state, R)
        return R

    before = forces()
    np.testing.assert_array_equal(forces(), before)
    for array in (s.state.d, s.state.d_old, s.state.velocity, s.state.extra["multipliers"], acting.penalties):
        array[-2:] += 0.1
        assert np.abs(forces() - before).max() > 1e-3
        before = forces()
    s.state.extra["q"][1] = rotation.of_vector(np.array([0.1, 0.2, 0.3]))
    assert np.abs(forces() - before).max() > 1e-3


@pytest.mark.parametrize("alpha", [1.0, 0.6])
def test_of_loads_that_follow(alpha: float) -> None:
    force = loads.load("rigid_follower_force")(0, 16, arm=np.array([0.3, 0.1, -0.4]), given=(1.0, 2.0, 3.0))
    moment = loads.load("rigid_follower_moment")(1, 18, given=(1.0, -2.0, 3.0))
    s = blocks.system(blocks.two_boxes(loads=[force, moment]))
    force.alpha = moment.alpha = alpha
    blocks.shaken(s)
    blocks.settle(s)
    blocks.shaken(s, seed=4)
    assert np.abs(agree(s)).max() > 1.0
    assert not s.symmetric


def test_of_inertia() -> None:
    """Translation to round-off; rotation as FEBio has it, exact where the body is at rest."""
    s = blocks.system(blocks.two_boxes(**blocks.dynamic()), dt=0.2)
    blocks.shaken(s, 1e-4)
    s.residual()
    exact, got = blocks.measured(s), blocks.assembled(s)
    np.testing.assert_allclose(got, exact, atol=2e-3 * np.abs(exact).max())
    shift = np.flatnonzero(np.isin(np.arange(12) % 6, (0, 1, 2)))
    np.testing.assert_allclose(got[np.ix_(shift, shift)], exact[np.ix_(shift, shift)], atol=1e-5)


@pytest.mark.parametrize("symmetric", [None, True])
def test_of_a_soft_cube_between_bodies(symmetric: bool | None) -> None:
    """The tangent lacks, as FEBio's does, what turning a force's arm adds: [f] [z] in the rows of moments."""
    problem = blocks.held_cube()
    problem.steps[0].newton.symmetric = symmetric
    s = blocks.system(problem)
    assert s.bodies is not None and s.symmetric
    blocks.shaken(s, 0.05)
    exact, got = blocks.measured(s), blocks.assembled(s)
    R = np.zeros_like(s.state.d)
    s.groups[0].physics.residual(0, 1, s.state, R, False)
    z = s.state.x[s.bodies.nodes] - s.state.x[s.bodies.owner[s.bodies.nodes]]
    for k, node in enumerate(s.bodies.nodes):
        e = s.eqs.eq[s.bodies.owner[node] + 1, :3]
        exact[np.ix_(e, e)] += rotation.skew(R[node, :3]) @ rotation.skew(z[k])
    np.testing.assert_allclose(got, exact, atol=1e-7)
    free = np.flatnonzero(s.bodies.owner[:16] < 0)
    np.testing.assert_array_equal(free, [11])


def test_what_is_prescribed_goes_to_the_right_side() -> None:
    """Minus the prescribed columns times the increments: those of the same tangent with nothing prescribed."""
    lead = [Prescribed(0, np.array([20]), Constant(0.1)), Prescribed(2, np.array([20]), Constant(0.2))]
    turn = [Prescribed(k, np.array([21]), Constant(0.1)) for k in range(3)]
    held = [Fixed(k, np.array([22])) for k in range(3)]
    free = blocks.system(blocks.held_cube(conditions=held))
    led = blocks.system(blocks.held_cube(conditions=[*lead, *turn, *held]))
    step = np.zeros(led.eqs.n)
    step[led.eqs.given] = np.arange(1.0, 6.0)
    _, Fd = led.tangent(step)
    full = blocks.assembled(free)
    np.testing.assert_allclose(Fd[led.eqs.rows], -(full @ step)[led.eqs.rows], atol=1e-12)
    rows = led.eqs.rows
    np.testing.assert_allclose(blocks.assembled(led), full[np.ix_(rows, rows)], atol=1e-12)
    assert not Fd[led.eqs.given].any()


def test_weight_of_bodies_acts_at_their_centre_of_mass() -> None:
    problem = blocks.two_boxes(body_loads=[ComponentForce(x=1.0, y=-2.0, z=3.0)])
    centre = problem.bodies[0].centre + np.array([0.1, 0.2, 0.3])
    problem.bodies[0] = blocks.box("first", 0, problem.X, centre=centre)
    R = blocks.system(problem).residual().reshape(4, 3)
    f = np.array([-1.0, 2.0, -3.0])  # FEBio's body force acts against its own direction
    np.testing.assert_allclose(R[0], 6 * f, atol=1e-12)
    np.testing.assert_allclose(R[1], np.cross((-0.1, -0.2, -0.3), 6 * f), atol=1e-12)
    np.testing.assert_allclose(R[2], 4 * f, atol=1e-12)
    np.testing.assert_allclose(R[3], 0.0, atol=1e-12)


def test_how_many_nodes_an_equation_moves() -> None:
    s = blocks.system(blocks.held_cube(conditions=[Fixed(0, np.array([20]))]))
    assert s.bodies is not None
    counted = s.bodies.counted(s.eqs)
    assert counted[s.eqs.eq[11, :3]].tolist() == [1, 1, 1]
    assert counted[s.eqs.eq[20, 1:3]].tolist() == [8, 8]  # its own
    assert counted[s.eqs.eq[22, :3]].tolist() == [11, 11, 11]  # its own and those attached
    assert not counted[s.eqs.eq[[21, 23], :3]].any()
