"""Elements that are taken away: who they are, what stays in balance, what is given back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from febkit.lower import unsupported
from febkit.model import InputError
from febkit.solver import physics
from febkit.solver.contact.surface import Facets
from febkit.solver.criteria import MEASURES, Listed, Range
from febkit.solver.erosion import Erosion, left
from febkit.solver.loads.base import patches
from febkit.solver.loads.pressure import Pressure
from febkit.solver.order import introsorted
from febkit.solver.problem import AutoStep, Block, Fixed, Prescribed, Problem, Step
from febkit.solver.run import Run
from febkit.solver.solids.mooney_rivlin import MooneyRivlin
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.values import Constant, Expression
from helpers import cube, scenes

RAMP = Expression(lambda X, Y, Z, t: 0.4 * t + 0 * X)


def bar(erosion: Erosion | None, n: int = 4, solid: Any = None, **step: Any) -> Problem:
    """A bar of n cubes along X, weakest where it is thinnest, pulled at its end."""
    X, conn = scenes.grid((n, 1, 1), (float(n), 1.0, 1.0))
    X[:, 1:] *= (1.0 + 0.1 * np.abs(X[:, :1] - 0.6 * n)) ** 2
    held, end = np.flatnonzero(X[:, 0] < 1e-9), np.flatnonzero(X[:, 0] > n - 1e-9)
    conditions: list[Any] = [Fixed(c, held) for c in range(3)] + [Prescribed(0, end, RAMP)]
    conditions += [Fixed(c, end) for c in (1, 2)]
    s = Step(dt=0.25, count=4, newton=scenes.tight(dtol=1e-9), conditions=conditions, **step)
    if erosion is not None:
        s.adaptors = [erosion]
    p = physics.load("three-field")() if isinstance(solid, MooneyRivlin) else physics.default()
    return Problem(X, [Block("bar", "hex8", conn, np.arange(len(conn)) + 1, solid or NeoHookean(10.0, 0.3), p)], [s])


def solved(problem: Problem) -> Run:
    r = Run(problem)
    result = r.solve()
    assert result.converged, result.reason
    return r


@pytest.mark.parametrize("solid", [None, MooneyRivlin(2.0, 0.1, k=40.0)])
def test_what_is_left_is_as_if_alone(solid: Any) -> None:
    """Two rows of cubes, one of which is taken away: the other is where it would be without."""
    X, conn = scenes.grid((3, 2, 1))
    top = X[conn][:, :, 1].mean(axis=1) > 0.5
    held, end = np.flatnonzero(X[:, 0] < 1e-9), np.flatnonzero(X[:, 0] > 1 - 1e-9)
    p = physics.load("three-field")() if solid else physics.default()
    last = []
    for gone in (True, False):
        conditions: list[Any] = [Fixed(c, held) for c in range(3)] + [Prescribed(0, end, RAMP)]
        step = Step(dt=0.5, count=2, newton=scenes.tight(dtol=1e-9), conditions=conditions)
        kept = conn if gone else conn[~top]
        if gone:
            step.adaptors = [Erosion(Listed(np.flatnonzero(top) + 1))]
        block = Block("bar", "hex8", kept, np.arange(len(kept)) + 1, solid or NeoHookean(10.0, 0.3), p)
        last.append(solved(Problem(X, [block], [step])))
    own = np.unique(conn[~top])
    np.testing.assert_allclose(last[0].state.u[own], last[1].state.u[own], atol=1e-9)
    np.testing.assert_allclose(last[0].groups[0].physics.s[~top], last[1].groups[0].physics.s, atol=1e-9)
    assert last[0].groups[0].wJ0[top].max() == 0.0 and (last[0].groups[0].alive == ~top).all()
    np.testing.assert_allclose(last[0].state.reaction.sum(axis=0), 0.0, atol=1e-9)


def test_the_thinnest_goes_first_and_what_is_cut_off_goes_slack() -> None:
    criterion = Range(MEASURES["von Mises stress"], least=1.2, clamp=False)
    r = solved(bar(Erosion(criterion, rounds=1, most=1, order=1)))
    gone = np.flatnonzero(~r.groups[0].alive)
    whole = solved(bar(None))
    assert gone.tolist() == [int(np.argmax(whole.groups[0].physics.s[:, :, 0].mean(axis=1)))]
    s = r.groups[0].physics.s
    assert np.abs(s[r.groups[0].alive]).max() < 1e-6 and s[gone].max() > 1.2  # what went keeps what it had
    assert r.totals.steps == 4


@pytest.mark.parametrize(("options", "count"), [
    ({}, 4), ({"most": 1}, 4), ({"most": 1, "rounds": 1}, 4), ({"most": 1, "rounds": 0}, 0),
    ({"elements": {"bar": np.array([2, 3])}}, 2),
])  # fmt: skip
def test_how_many_go(options: dict[str, Any], count: int) -> None:
    """All of a criterion's, some at a time until none is left, once a step (four steps), never, of a set."""
    problem = bar(Erosion(Range(MEASURES["relative volume"], 0.0, 2.0), **options))
    problem.steps[0].conditions = [Fixed(c, np.arange(len(problem.X))) for c in range(3)]
    r = solved(problem)
    assert (~r.groups[0].alive).sum() == count


def test_islands_go_as_well() -> None:
    """The middle of three cubes goes; the last hangs on nothing."""
    X, conn = scenes.grid((3, 1, 1))
    step = Step(dt=1.0, count=1, conditions=[Fixed(c, np.flatnonzero(X[:, 0] < 1e-9)) for c in range(3)])
    step.adaptors = [Erosion(Listed(np.array([2])), islands=True)]
    block = Block("bar", "hex8", conn, np.arange(3) + 1, NeoHookean(1.0, 0.3))
    assert solved(Problem(X, [block], [step])).groups[0].alive.tolist() == [True, False, False]


def test_a_step_that_fails_gives_elements_back() -> None:
    """The second try of a step erodes what the first did: the end is that of small steps."""
    criterion = Range(MEASURES["von Mises stress"], least=1.2, clamp=False)
    problem = bar(Erosion(criterion, rounds=1, most=1, order=1), auto=AutoStep(dtmax=0.25, max_retries=5))
    r = Run(problem)
    newton_step, failed = None, []

    from febkit.solver.newton import Newton, NotConverged

    newton_step = Newton.step

    def step(self: Any, how: Any = None) -> Any:
        eroded = not self.system.groups[0].alive.all()
        if eroded and not failed:
            failed.append(True)
            raise NotConverged("on purpose")
        return newton_step(self, how)

    Newton.step = step  # type: ignore[method-assign]
    try:
        result = r.solve()
    finally:
        Newton.step = newton_step  # type: ignore[method-assign]
    assert result.converged and failed and r.totals.retries == 1
    other = solved(bar(Erosion(criterion, rounds=1, most=1, order=1), auto=AutoStep(dtmax=0.25)))
    np.testing.assert_array_equal(r.groups[0].alive, other.groups[0].alive)
    np.testing.assert_allclose(r.state.u, other.state.u, atol=1e-7)


def test_a_load_on_what_goes_is_said() -> None:
    problem = bar(Erosion(Listed(np.array([2]))))
    X, conn = problem.X, problem.blocks[0].conn
    on = patches({"quad4": conn[1:2, [0, 3, 2, 1]]}, X)
    problem.steps[0].loads = [Pressure(on, pressure=Constant(1e-3))]
    result = Run(problem).solve()
    assert not result.converged and "element 2 of part 'bar' erodes under a load" in result.reason


@pytest.mark.parametrize("grow", [False, True])
def test_surfaces_of_what_goes(grow: bool) -> None:
    """The top facet of a cube goes with it; grown, the walls that lie bare come instead, facing out."""
    X, conn = scenes.grid((2, 2, 2))
    top = conn[:, 4:][X[conn][:, :, 2].mean(axis=1) > 0.5]
    owner = np.column_stack([np.zeros(4, int), np.flatnonzero(X[conn][:, :, 2].mean(axis=1) > 0.5)])
    problem = Problem(X, [Block("cube", "hex8", conn, np.arange(8) + 1, NeoHookean(1.0, 0.3))], [Step()])
    r = Run(problem)
    r._set_up()
    dead = np.zeros(8, bool)
    dead[owner[0, 1]] = True
    r.groups[0].erode(dead)
    new = left(Facets({"quad4": top}, {"quad4": owner}), r.groups, grow)
    faces = new.conn["quad4"]
    assert len(faces) == (6 if grow else 3) and r.groups[0].alive[new.owner["quad4"][:, 1]].all()
    x = X[faces]
    normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    inside = X[conn[new.owner["quad4"][:, 1]]].mean(axis=1)
    assert ((x.mean(axis=1) - inside) * normal).sum(axis=1).min() > 0


def test_equal_values_are_in_the_order_of_the_c_library() -> None:
    """std::sort of GCC by decreasing value; up to 16 it inserts, which keeps equal ones as they are."""
    assert introsorted([1.0] * 18, True) == [9, 17, 16, 15, 14, 13, 12, 11, 10, 0, 8, 7, 6, 5, 4, 3, 2, 1]
    mixed = [1.0, 3, 2, 3, 1, 2, 2, 3, 1, 1, 2, 3, 3, 2, 1, 1, 3, 2, 2, 1]
    assert introsorted(mixed, True) == [1, 3, 16, 7, 12, 11, 10, 18, 17, 13, 6, 5, 2, 0, 9, 8, 14, 15, 4, 19]
    assert introsorted([2.0, 1.0, 3.0, 1.0], False) == [1, 3, 0, 2]


SOLID = '<material id="1" name="m" type="neo-Hookean"><density>1</density><E>1</E><v>0.3</v></material>'


def adaptor(inside: str, kind: str = "erosion") -> str:
    return f'<MeshAdaptor><mesh_adaptor type="{kind}">{inside}</mesh_adaptor></MeshAdaptor>'


STRESS = ('<criterion type="min-max filter"><min>0.1</min><clamp>0</clamp><data type="stress"><metric>1</metric></data>'
          "</criterion>")  # fmt: skip


@pytest.mark.parametrize(("inside", "says"), [
    (STRESS, ""),
    ('<max_iters>2</max_iters><max_elems>3</max_elems><sort>2</sort><criterion type="damage"/>', ""),
    ('<criterion type="element_selection"><element_list>1</element_list></criterion>', ""),
    ('<criterion type="element data"><element_data>s1</element_data></criterion>', ""),
    ('<criterion type="element data"><element_data>nothing</element_data></criterion>', "<element_data>nothing"),
    ('<criterion type="relative error"><data type="relative volume"/></criterion>', ""),
    ('<criterion type="min-max filter"><data type="spring force"/></criterion>', 'data type="spring force"'),
    (STRESS + "<erode_surfaces>reconstruct</erode_surfaces>", "reconstruct"),
])  # fmt: skip
def test_adaptors_are_read(tmp_path: Path, inside: str, says: str) -> None:
    found = [str(e) for e in unsupported(cube.read(tmp_path, cube.text(SOLID, more=adaptor(inside))))]
    assert len(found) == bool(says) and all(says in f for f in found)
    if not says:
        (erosion,) = cube.problem(tmp_path, cube.text(SOLID, more=adaptor(inside))).common.adaptors
        assert erosion.rounds in (-1, 2)


def test_adaptors_that_mesh_anew_are_refused(tmp_path: Path) -> None:
    found = unsupported(cube.read(tmp_path, cube.text(SOLID, more=adaptor("", "mmg_remesh"))))
    assert ['<mesh_adaptor type="mmg_remesh">' in str(e) for e in found] == [True]
    with pytest.raises(InputError, match="criterion"):
        cube.problem(tmp_path, cube.text(SOLID, more=adaptor("")))
