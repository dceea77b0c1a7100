"""Derivatives by parameters against central differences of whole runs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

from febkit.solver import contact, loads, permeabilities
from febkit.solver.options import Options
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.physics.three_field import Augment, ThreeField
from febkit.solver.problem import DYNAMIC, TRANSIENT, Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.rigid import joints
from febkit.solver.run import Run
from febkit.solver.sensitivity import BOTH, Sensitivities, refusal
from febkit.solver.solids.base import Solid
from febkit.solver.solids.isotropic_elastic import IsotropicElastic
from febkit.solver.solids.mooney_rivlin import MooneyRivlin
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.solids.registry import tables
from febkit.solver.solids.solid_mixture import SolidMixture
from febkit.solver.solids.viscoelastic import Viscoelastic
from febkit.solver.values import Constant, Scaled
from helpers import blocks, examples, scenes, varying
from helpers.pair import Pair

H = 1e-5  # of the parameters, in central differences
Numbers = dict[str, float]
Make = Callable[[Numbers], tuple[Problem, Numbers]]  # added to parameters -> problem, the parameters' numbers


def solved(problem: Problem, *listeners: Any) -> Run:
    run = Run(problem, listeners, Options(threads=1))
    result = run.solve()
    assert result.converged, result.reason
    return run


def compared(
    make: Make, tolerance: float = 1e-8, sides: tuple[float, ...] = (BOTH, -BOTH)
) -> tuple[float, Sensitivities]:
    """The largest error of d(displacements, reactions), over the sum of what the parameters do to either.

    In the two runs of the differences all parameters move, each by an amount of its own.
    """
    base, numbers = make({})
    names = [n for n, v in numbers.items() if v and not n.endswith("density_")]
    varied = []
    for n in names:
        added = [(numbers[n] + h * abs(numbers[n])) - numbers[n] for h in sides]
        varied.append([(make({n: a})[0], a) for a in added])
    s = Sensitivities(varied, tolerance)
    solved(base, s)
    assert not any(v.lost for v in s.all), [v.lost for v in s.all]
    way = {n: w * abs(numbers[n]) for n, w in zip(names, np.random.default_rng(1).uniform(0.5, 1.5, len(names)))}
    ends = [solved(make({n: sign * H * w for n, w in way.items()})[0]) for sign in (1, -1)]
    errors = [0.0]
    for what in ("d", "reaction"):
        each = [s.of(k, lambda r: getattr(r.state, what)) * w for k, w in enumerate(way.values())]  # noqa: B023
        high, low = (getattr(r.state, what) for r in ends)
        scale = sum(np.abs(e).max() for e in each)
        if scale > 1e-6:
            errors.append(float(np.abs(sum(each) - (high - low) / (2 * H)).max() / scale))
    return max(errors), s


# ---- laws -----------------------------------------------------------------------------------------------------------
X, CONN = scenes.box("hex8", (1, 1, 1))
X = X + np.random.default_rng(3).uniform(-0.05, 0.05, X.shape) * (X[:, 2:] > 0.5)
LOW, HIGH = (np.flatnonzero(np.abs(X[:, 2] - z) < 0.2) for z in (0.0, 1.0))


def sheared(solid: Solid, physics: Any = None, stretch: float = -0.06, **step: Any) -> Problem:
    """An element stretched and sheared in two steps."""
    held: list[Any] = [*(Fixed(c, LOW) for c in range(3)), Prescribed(2, HIGH, scenes.ramp(stretch, 0.6))]
    held.append(Prescribed(0, HIGH[:2], scenes.ramp(0.04, 0.6)))
    given: dict[str, Any] = {"newton": scenes.tight(dtol=1e-11, ptol=1e-11, max_reforms=200), **step}
    return Problem(X, [scenes.block("hex8", CONN, solid, physics)], [Step(dt=0.3, count=2, conditions=held, **given)])


def _law(name: str, amounts: Numbers) -> tuple[Problem, Numbers]:
    solid = LAWS[name]()
    numbers = varying.moved(solid, amounts)
    numbers.pop(JUMPS.get(name, ""), None)
    return sheared(SolidMixture(solid=(NeoHookean(2.0, 0.3), solid))), numbers


LAWS = {n: partial(examples.example, n) for n in sorted(tables()["solid"])} | examples.nested()
del LAWS["micro-material"]  # its numbers are those of its volume
JUMPS = {"lung": "d3"}  # where it is a whole number, powers of what may be negative


@pytest.mark.parametrize("name", LAWS)
def test_parameters_of_laws(name: str) -> None:
    error, _ = compared(partial(_law, name))
    assert error < 1e-5


# ---- fluids, dynamics, multipliers, contact, rigid bodies -----------------------------------------------------------
def _fluid(name: str, amounts: Numbers) -> tuple[Problem, Numbers]:
    """A porous element that drains at one side, its solid fraction among the parameters."""
    mix = Biphasic(permeabilities.load(name)(**varying.PERMEABILITIES[name]), phi0=Constant(0.2))
    numbers = varying.moved(mix, amounts)
    problem = sheared(NeoHookean(1.0, 0.3), mix, analysis=TRANSIENT)
    problem.steps[0].conditions.append(Fixed(problem.layout.column("p"), HIGH))
    return problem, numbers


@pytest.mark.parametrize("name", permeabilities.TYPES)
def test_parameters_of_permeabilities(name: str) -> None:
    error, s = compared(partial(_fluid, name))
    assert error < 1e-5
    assert np.abs(s.of(0, lambda r: r.state.p)).max() > 1e-4


def _of_solid(make: Callable[[Solid], Problem], solid: Solid, amounts: Numbers) -> tuple[Problem, Numbers]:
    numbers = varying.moved(solid, amounts)
    return make(solid), numbers


def _dynamic(solid: Solid) -> Problem:
    """In a frame that turns ever faster, with a viscous part."""
    frame = loads.load("moving frame")(wz=scenes.ramp(2.0, 1.0), ax=0.2)
    newton = scenes.tight(dtol=1e-11)
    return sheared(Viscoelastic(solid, g1=0.5, t1=0.3), body_loads=[frame], analysis=DYNAMIC, newton=newton)


def _touching(name: str, solid: Solid, **kw: Any) -> Problem:
    """The upper of two blocks is pressed on the lower one, and pulled aside."""
    pair = Pair(inset=0.05)
    pair.blocks[0].solid = pair.blocks[1].solid = solid
    problem = pair.problem(contact.load(name, "fric_coeff" in kw)(**pair.sides, penalty=20.0, **kw), 0.0, dtol=1e-10)
    top = pair.at(2.0)
    problem.steps[0].conditions = [
        *(Fixed(c, pair.at(0.0)) for c in range(3)), Fixed(1, top),
        Prescribed(0, top, scenes.ramp(0.02, 1.0)), Prescribed(2, top, scenes.ramp(-0.02, 1.0)),
    ]  # fmt: skip
    problem.steps[0].dt, problem.steps[0].count = 0.5, 2
    problem.steps[0].newton.max_reforms = 100
    return problem


SCENES: dict[str, Make] = {
    "dynamic": lambda a: _of_solid(_dynamic, NeoHookean(3.0, 0.3), a),
    "element pressures": lambda a: _of_solid(
        lambda s: sheared(s, ThreeField(Augment(1e-3, 1, 5)), newton=scenes.tight(dtol=1e-12)),
        MooneyRivlin(1.0, 0.2, k=50.0), a,
    ),
    "sliding": lambda a: _of_solid(
        lambda s: _touching("sliding-elastic", s, auto_penalty=True, two_pass=True, laugon=True),
        IsotropicElastic(2.0, 0.3), a,
    ),
    "tied": lambda a: _of_solid(lambda s: _touching("tied-elastic", s), IsotropicElastic(2.0, 0.3), a),
}  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_parameters_of_solids(name: str) -> None:
    assert compared(SCENES[name])[0] < 1e-5


def test_load_on_rigid_bodies_that_turn() -> None:
    """By the force on one of two that a joint with multipliers ties."""

    def make(amounts: Numbers) -> tuple[Problem, Numbers]:
        lock = joints.Lock(0, 1, origin=np.array([2.0, 1.0, 1.0]), gaptol=1e-9, angtol=1e-9, maxaug=1)
        value = Scaled(Constant(0.3 + amounts.get("force", 0.0)), lambda t: min(t, 1.0))
        push = loads.load("rigid_force")(1, 18, axis=1, value=value)
        held = [Fixed(k, np.array([16, 17])) for k in range(3)]
        newton = NewtonOptions(method="full Newton", updates=0, dtol=1e-9, etol=0, max_reforms=60)
        step = {"dt": 0.5, "count": 2, "newton": newton}
        return blocks.two_boxes(connectors=[lock], loads=[push], conditions=held, **step), {"force": 0.3}

    assert compared(make)[0] < 1e-5


def test_what_is_not_differentiated_is_said() -> None:
    rubbing = _touching("sliding-elastic", IsotropicElastic(2.0, 0.3), fric_coeff=0.3)
    assert "SlidingFriction depends on how iterations go" in refusal(rubbing)
    assert refusal(SCENES["sliding"]({})[0]) == ""


def test_a_parameter_at_which_the_answer_jumps_is_given_up() -> None:
    """The exponent 3 of a number that is negative."""

    def make(amount: float) -> Problem:
        solid = examples.example("lung")
        varying.moved(solid, {"d3": amount})
        return sheared(solid)

    s = Sensitivities([[(make(1e-6), 1e-6)]])
    solved(make(0.0), s)
    assert "jumps" in s.lost(0)
