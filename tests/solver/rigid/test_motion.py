"""Bodies in motion against mechanics."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.loads.body_force import ComponentForce
from febkit.solver.problem import Fixed, Initial, NewtonOptions, Problem, Step
from febkit.solver.rigid import connectors, joints, rotation
from febkit.solver.run import Listener, Run, run
from febkit.solver.values import Constant
from helpers import blocks


class Track(Listener):
    """State of the rows of a body after every step."""

    def __init__(self) -> None:
        self.at: list[dict[str, np.ndarray]] = []

    def converged(self, run: Run, counts: object) -> None:
        s = run.state
        self.at.append({"d": s.d.copy(), "v": s.velocity.copy(), "q": s.extra["q"].copy(), "t": np.array(s.time)})

    def __getitem__(self, name: str) -> np.ndarray:
        return np.array([x[name] for x in self.at])


def one_box(centre: tuple[float, float, float] | None = None, **step: object) -> Problem:
    X = blocks.CORNERS * (1, 2, 3)
    body = blocks.box("only", 0, X, centre=None if centre is None else np.array(centre))
    return Problem(X, [], [Step(**step)], bodies=[body])  # type: ignore[arg-type]


def follow(problem: Problem) -> Track:
    track = Track()
    result = run(problem, [track])
    assert result.converged, result.reason
    return track


def test_mass_centre_and_inertia_of_a_box() -> None:
    body = one_box().bodies[0]
    assert body.mass == pytest.approx(6.0)
    np.testing.assert_allclose(body.centre, (0.5, 1.0, 1.5))
    np.testing.assert_allclose(body.inertia, 0.5 * np.diag([4 + 9, 1 + 9, 1 + 4]), atol=1e-12)


def test_a_box_falls() -> None:
    step = blocks.dynamic(dt=0.1, count=10, body_loads=[ComponentForce(z=9.81)])
    d = follow(one_box(**step))["d"]
    np.testing.assert_allclose(d[-1][:8], [[0, 0, -0.5 * 9.81]] * 8, rtol=1e-9, atol=1e-12)


def test_a_tumbling_box_keeps_its_angular_momentum() -> None:
    """About the middle axis, nearly: it turns over. FEBio starts from rotational accelerations of almost nothing, so
    that the trapezoidal rule is of first order."""
    w = (0.05, 2.0, 0.05)  # inertia 6.5, 5, 2.5
    spin = [Initial(k, np.array([9]), Constant(w[k]), velocity=True) for k in range(3)]
    change = []
    for n in (150, 300):
        problem = one_box(**blocks.dynamic(dt=8.0 / n, count=n, initial=spin))
        track, J = follow(problem), problem.bodies[0].inertia
        Q = np.array([rotation.matrix(q[0]) for q in track["q"]])
        v = track["v"][:, 9]
        h = np.einsum("tij,jk,tlk,tl->ti", Q, J, Q, v)
        energy = 0.5 * (h * v).sum(axis=1)
        assert np.abs(Q[:, 1, 1] - 1).max() > 1.5  # it has turned over
        change.append((np.abs(h - J @ w).max(), np.ptp(energy)))
    assert change[0][0] < 1e-3 * np.linalg.norm(J @ w) and change[0][1] < 1e-3 * energy[0]
    assert change[1][0] < 0.55 * change[0][0] and change[1][1] < 0.55 * change[0][1]
    np.testing.assert_allclose(track["d"][-1][8], 0.0, atol=1e-12)


@pytest.mark.parametrize("joint", ["held centre", "revolute"])
def test_a_pendulum_swings_in_time(joint: str) -> None:
    """A box hung at its edge from rest at 60 degrees: a quarter period is K(sin 30) sqrt(J / m g l)."""
    turned = rotation.matrix(rotation.of_vector(np.array([np.pi / 3, 0.0, 0.0])))
    J, l, g = 0.5 * 13 + 6 * 1.5**2, 1.5, 9.81
    X = (blocks.CORNERS * (1, 2, 3) - (0.5, 1.0, 3.0)) @ turned.T  # hung at the middle of its top
    # complete elliptic integral by the arithmetic-geometric mean
    a, b = 1.0, np.cos(np.pi / 6)
    for _ in range(6):
        a, b = 0.5 * (a + b), np.sqrt(a * b)
    quarter = np.pi / (2 * a) * np.sqrt(J / (6 * g * l))
    n = 100
    step = blocks.dynamic(dt=quarter / n, count=n, body_loads=[ComponentForce(z=g)])
    centre = np.zeros(3) if joint == "held centre" else None
    bodies = [blocks.box("pendulum", 0, X, centre=centre)]
    if joint == "held centre":
        step["conditions"] = [Fixed(k, np.array([8])) for k in range(3)]
        np.testing.assert_allclose(bodies[0].inertia[0, 0], J)
    else:
        ground = blocks.RigidBody("ground")
        bodies.append(ground)
        step["conditions"] = [Fixed(k, np.array([10 + i])) for k in range(3) for i in range(2)]
        hinge = joints.Revolute(
            1, 0, axes=joints.axes(np.array([1.0, 0, 0]), np.array([0, 1.0, 0])), force_penalty=1e6,
            moment_penalty=1e6, gaptol=1e-5, angtol=1e-5,
        )  # fmt: skip
        step["connectors"] = [hinge]
        step["newton"].dtol = 1e-6
    track = follow(Problem(X, [], [Step(**step)], bodies=bodies))
    low = (X + track["d"][-1][:8]).mean(axis=0)
    np.testing.assert_allclose(low, (0.0, 0.0, -l), atol=1.6e-2)  # half a step late, see above
    kinetic = 0.5 * J * track["v"][-1][9, 0] ** 2
    assert kinetic == pytest.approx(6 * g * l * (1 - np.cos(np.pi / 3)), rel=5e-3)


def test_two_boxes_on_a_spring_swing_about_their_common_centre() -> None:
    """Masses 6 and 4, k = 10, let go with the spring stretched by 1: half a period is pi sqrt(m / k), m = 2.4."""
    line = np.array([[0.5, 1.0, 1.5], [5.0, 1.0, 1.5]])
    spring = connectors.Spring(0, 1, *line, k=10.0, free_length=3.5)
    half = np.pi * np.sqrt(2.4 / 10)
    still = [Fixed(k, np.arange(16, 20)) for k in (1, 2)] + [Fixed(0, np.array([17, 19]))]
    problem = blocks.two_boxes(**blocks.dynamic(dt=half / 100, count=100, connectors=[spring], conditions=still))
    track = follow(problem)
    u = track["d"][:, [16, 18], 0]
    np.testing.assert_allclose(u @ [6, 4], 0.0, atol=1e-9)
    assert u[-1, 1] - u[-1, 0] == pytest.approx(-2.0, rel=2e-3)


def test_a_soft_cube_hangs_on_a_box_in_balance() -> None:
    """The moment on a free body vanishes: what is pulled aside swings into line."""
    from febkit.solver.loads import load

    pull = load("rigid_force")(1, 22, axis=0, value=0.05)
    held = [Fixed(k, np.array([20, 21])) for k in range(3)]
    problem = blocks.held_cube(loads=[pull], conditions=held, dt=0.25, count=4, newton=NewtonOptions(dtol=1e-8, etol=0))
    result = run(problem)
    assert result.converged, result.reason
    s = result.state
    f = -s.reaction[[8, 9, 10]]  # of the cube on the nodes attached to the box
    np.testing.assert_allclose(f.sum(axis=0) + np.array([0.05, 0, 0]), 0.0, atol=1e-7)
    centre = problem.bodies[1].centre + s.d[22, :3]
    np.testing.assert_allclose(np.cross((s.X + s.d)[[8, 9, 10]] - centre, f).sum(axis=0), 0.0, atol=1e-7)
    assert np.abs(s.d[23]).max() > 0.01
    z = s.X[[8, 9, 10]] - problem.bodies[1].centre
    turned = z @ rotation.matrix(s.extra["q"][1]).T
    np.testing.assert_allclose((s.X + s.d)[[8, 9, 10]], centre + turned, atol=1e-12)


def test_what_cannot_be_had_with_bodies() -> None:
    from febkit.solver.options import Options
    from febkit.solver.second_order import refusal

    with pytest.raises(ValueError, match="multigrid"):
        run(one_box(dt=1.0, count=1), options=Options(linear="iterative"))
    problem = one_box(dt=1.0, count=1, analysis="transient")
    problem.__class__ = type("Mixed", (Problem,), {"diffuses": True})
    assert "rigid bodies" in refusal(problem)


def test_multipliers_close_a_joint() -> None:
    lock = joints.Lock(0, 1, origin=np.array([2.0, 1.0, 1.0]), gaptol=1e-9, angtol=1e-9, maxaug=50)
    from febkit.solver.loads import load

    push = load("rigid_force")(1, 18, axis=1, value=0.3)
    held = [Fixed(k, np.array([16, 17])) for k in range(3)]
    options = NewtonOptions(method="full Newton", updates=0, dtol=1e-9, etol=0, min_residual=1e-24)
    problem = blocks.two_boxes(connectors=[lock], loads=[push], conditions=held, dt=1.0, count=1, newton=options)
    result = run(problem)
    assert result.converged, result.reason
    np.testing.assert_allclose(result.state.d[18:20], 0.0, atol=1e-7)
    multipliers = result.state.extra["multipliers"][0]
    np.testing.assert_allclose(np.abs(multipliers[:3]), (0, 0.3, 0), atol=1e-7)
