"""A try at a time step that fails leaves nothing behind, nor does a run in the problem that it solved."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from febkit._version import __version__
from febkit.checkpoint import read, write
from febkit.solver import contact, loads
from febkit.solver.checkpoint import Resumed, taken
from febkit.solver.newton import Newton, NotConverged, Strategy
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.physics.three_field import Augment, ThreeField
from febkit.solver.problem import TRANSIENT, AutoStep, Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.rigid import joints
from febkit.solver.run import Listener, Run, run
from febkit.solver.solids.mooney_rivlin import MooneyRivlin
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.solids.viscoelastic import Viscoelastic
from helpers import blocks, scenes
from helpers.pair import Pair


def pressed(solid: Any, physics: Any = None, **step: Any) -> Problem:
    """A cube pressed down in four steps."""
    X, conn = scenes.box("hex8", (2, 2, 2))
    low, high = (np.flatnonzero(np.abs(X[:, 2] - z) < 1e-9) for z in (0.0, 1.0))
    held: list[Any] = [*(Fixed(c, low) for c in range(3)), Prescribed(2, high, scenes.ramp(-0.2, 1.0))]
    return Problem(X, [scenes.block("hex8", conn, solid, physics)], [Step(dt=0.25, count=4, conditions=held, **step)])


def touching(name: str, **kw: Any) -> Problem:
    """Two blocks in contact, the upper one pressed down and pulled aside."""
    pair = Pair(inset=0.05)
    c = contact.load(name, "fric_coeff" in kw)(**pair.sides, penalty=20.0, laugon=True, **kw)
    problem = pair.problem(c, 0.0)
    top = pair.at(2.0)
    problem.steps[0].conditions = [
        *(Fixed(c, pair.at(0.0)) for c in range(3)), Fixed(1, top),
        Prescribed(0, top, scenes.ramp(0.02, 1.0)), Prescribed(2, top, scenes.ramp(-0.02, 1.0)),
    ]  # fmt: skip
    problem.steps[0].newton = NewtonOptions(max_reforms=50)
    problem.steps[0].dt, problem.steps[0].count = 0.25, 4
    return problem


def joined() -> Problem:
    """Rigid boxes whose joint's penalties grow as its gap stays too large."""
    lock = joints.Lock(0, 1, origin=np.array([2.0, 1.0, 1.0]), gaptol=1e-3, angtol=1e-3, maxaug=4, auto_penalty=True)
    push = loads.load("rigid_force")(1, 18, axis=1, value=scenes.ramp(0.3, 1.0))
    held = [Fixed(k, np.array([16, 17])) for k in range(3)]
    newton = NewtonOptions(method="full Newton", updates=0, dtol=1e-4, etol=0, max_reforms=60)
    return blocks.two_boxes(connectors=[lock], loads=[push], conditions=held, dt=0.25, count=4, newton=newton)


def turning() -> Problem:
    """A damped cube in a frame that turns ever faster."""
    frame = loads.load("moving frame")(wz=scenes.ramp(2.0, 1.0), ax=0.2)
    return pressed(NeoHookean(3.0, 0.3), body_loads=[frame, loads.load("mass damping")(C=0.5)], **_dynamic())


def _dynamic() -> dict[str, Any]:
    made = blocks.dynamic()
    return {"analysis": made["analysis"], "newton": made["newton"]}


def pulled() -> Problem:
    """A nodal load on top of the force that held its nodes."""
    problem = pressed(NeoHookean(3.0, 0.3))
    X, first = problem.X, problem.steps[0]
    top = np.flatnonzero(X[:, 2] > 1 - 1e-9)
    load = loads.load("nodal_force")(top, X[top], value=(0.01, 0.0, 0.02), relative=True)
    problem.steps.append(Step(dt=0.25, count=4, conditions=first.conditions[:3], loads=[load]))
    return problem


SCENES: dict[str, Callable[[], Problem]] = {
    "element pressures": lambda: pressed(MooneyRivlin(1.0, 0.2, k=50.0), ThreeField(Augment(1e-3, 1, 5))),
    "history": lambda: pressed(Viscoelastic(NeoHookean(1.0, 0.3), g1=0.5, t1=0.3)),
    "fluid": lambda: pressed(NeoHookean(1.0, 0.3), Biphasic(ConstIso(0.1)), analysis=TRANSIENT),
    "sliding": lambda: touching("sliding-elastic", auto_penalty=True, two_pass=True, seg_up=3),
    "friction": lambda: touching("sliding-elastic", fric_coeff=0.3),
    "nodes": lambda: touching("sliding-node-on-facet", gaptol=1e-4),
    "tied": lambda: touching("tied-elastic"),
    "joint": joined,
    "frame": turning,
    "relative load": pulled,
}


def interrupted(problem: Problem, monkeypatch: pytest.MonkeyPatch, late: bool) -> Any:
    """Solve with tries that fail, at the second and third step: once done (``late``), or before they began."""
    step, tries = Newton.step, iter(range(10**6))

    def solve(self: Newton, how: Strategy) -> Any:
        fails = next(tries) in (1, 3)
        if fails and not late:
            raise NotConverged("not tried")
        out = step(self, how)
        if fails:
            raise NotConverged("given up")
        return out

    monkeypatch.setattr(Newton, "step", solve)
    for s in problem.steps:
        s.auto = AutoStep(dtmax=s.dt)
    result = run(problem, options=Options(threads=1))
    monkeypatch.setattr(Newton, "step", step)
    assert result.converged and result.totals.retries >= 2, result.reason
    return result.state


@pytest.mark.parametrize("name", SCENES)
def test_a_failed_try_leaves_nothing_behind(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    late, early = (interrupted(SCENES[name](), monkeypatch, late) for late in (True, False))
    for a in ("d", "velocity", "acceleration", "reaction"):
        np.testing.assert_array_equal(getattr(late, a), getattr(early, a))
    assert np.abs(late.d).max() > 1e-5


@pytest.mark.parametrize("name", SCENES)
def test_a_problem_is_solved_twice(name: str) -> None:
    problem = SCENES[name]()
    first, second = (run(problem, options=Options(threads=1)) for _ in range(2))
    assert first.converged and second.converged
    np.testing.assert_array_equal(first.state.d, second.state.d)


class Keeps(Listener):
    """Writes one checkpoint, after so many steps."""

    def __init__(self, path: Path, steps: int) -> None:
        self.path, self.steps = path, steps

    def stepped(self, run: Run) -> None:
        if run.totals.steps == self.steps and not run.over:
            write(self.path, {"febkit": __version__}, taken(run))


def gone_on(make: Callable[[], Problem], options: Options, steps: int, path: Path) -> tuple[Run, Run]:
    """A run that kept a checkpoint, and one that went on from it."""
    whole = Run(make(), [Keeps(path, steps)], options)
    whole.remembers = True
    assert whole.solve().converged
    rest = Run(make(), [], options)
    rest.resumed = Resumed(read(path).run)
    assert rest.solve().converged
    return whole, rest


def leaning() -> Problem:
    """A layer of fluid-filled tissue in many steps, which lean on old factorisations."""
    problem = pressed(NeoHookean(1.0, 0.3), Biphasic(ConstIso(0.1)), analysis=TRANSIENT)
    problem.steps[0].dt, problem.steps[0].count = 0.02, 50
    return problem


FULL = NewtonOptions(method="full Newton", updates=0)  # which iterates over factorisations of earlier tangents
KEPT: dict[str, tuple[Callable[[], Problem], Options, int]] = {
    **{name: (make, Options(threads=1), 2) for name, make in SCENES.items()},
    "second step of a relative load": (pulled, Options(threads=1), 6),
    "kept factorisation": (leaning, Options(threads=1, factor="reuse", linear="pardiso"), 17),
    "earlier tangent": (
        lambda: pressed(NeoHookean(3.0, 0.3), newton=FULL), Options(threads=1, factor="reuse", linear="pardiso"), 2
    ),
    "error steps": (SCENES["fluid"], Options(threads=1, accuracy=1e-3), 5),
}  # fmt: skip


@pytest.mark.parametrize("name", KEPT)
def test_a_run_goes_on_from_a_checkpoint_bit_for_bit(name: str, tmp_path: Path) -> None:
    whole, rest = gone_on(*KEPT[name], tmp_path / "c")
    for a in ("d", "velocity", "acceleration", "reaction"):
        np.testing.assert_array_equal(getattr(rest.state, a), getattr(whole.state, a))
    for a, b in zip(rest.groups, whole.groups):
        np.testing.assert_array_equal(a.new, b.new)
    assert rest.times == whole.times
    assert (rest.totals.steps, rest.totals.iterations) == (whole.totals.steps, whole.totals.iterations)
