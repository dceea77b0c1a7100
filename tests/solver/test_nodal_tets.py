"""Tetrahedra integrated at their nodes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from febkit.lower import lower
from febkit.model import InputError
from febkit.solver import physics
from febkit.solver.problem import Block, Fixed, Problem, Step
from febkit.solver.run import Run, run
from febkit.solver.solids.mooney_rivlin import MooneyRivlin
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.system import System
from febkit.solver.values import Expression
from helpers import blocks, cube, scenes

X, CONN = scenes.box("tet4", (2, 2, 2), 0.3)
SOLIDS = [NeoHookean(3.0, 0.4), MooneyRivlin(1.0, 0.2, k=50.0)]
VARIED = NeoHookean(Expression(lambda X, Y, Z, t: 2.0 + X + 0.5 * Y * Z), 0.3)


def problem(solid: Any, isochoric: bool, step: Step, alpha: float = 0.1) -> Problem:
    p = physics.load("ut4")(alpha, isochoric)
    return Problem(X, [Block("tets", "tet4", CONN, np.arange(len(CONN)) + 1, solid, p)], [step])


def deformed(solid: Any, isochoric: bool, u: Any, symmetric: bool | None = None) -> System:
    """The system at displacements u (node, 3), the base held."""
    newton = scenes.tight(symmetric=symmetric)
    base = np.flatnonzero(X[:, 2] < 1e-9)
    step = Step(newton=newton, conditions=[Fixed(c, base) for c in range(3)])
    r = Run(problem(solid, isochoric, step))
    r._set_up()
    s = System(r.problem, step, r.groups, r.state, r.schedule)
    r.state.d[:] = u
    s.set(s.gather(r.state.d), np.zeros(s.eqs.n), np.zeros(s.eqs.n), r.state.d)
    return s


def motion(amount: float) -> Any:
    return amount * np.random.default_rng(2).normal(size=X.shape) * (X[:, 2:] > 1e-9)


@pytest.mark.parametrize("isochoric", [False, True])
@pytest.mark.parametrize("solid", [*SOLIDS, VARIED])
def test_tangent(solid: Any, isochoric: bool) -> None:
    s = deformed(solid, isochoric, motion(0.05))
    d, zero, h = s.gather(s.state.d), np.zeros(s.eqs.n), 1e-6
    K = blocks.assembled(s)
    assert s.symmetric is not isochoric
    exact = np.empty_like(K)
    for i in range(s.eqs.n):
        u = zero.copy()
        u[i] = h
        s.set(d, zero, u, s.state.d)
        up = s.residual()
        s.set(d, zero, -u, s.state.d)
        exact[:, i] = -(up - s.residual()) / (2 * h)
    np.testing.assert_allclose(K, exact, atol=1e-7 * np.abs(exact).max())


def test_a_symmetric_matrix_has_the_symmetric_part() -> None:
    u = motion(0.05)
    K = blocks.assembled(deformed(SOLIDS[0], True, u))
    S = blocks.assembled(deformed(SOLIDS[0], True, u, symmetric=True))
    np.testing.assert_allclose(S, 0.5 * (K + K.T), atol=1e-12 * np.abs(K).max())


@pytest.mark.parametrize("isochoric", [False, True])
def test_patch(isochoric: bool) -> None:
    """An affine displacement of the skin: the same inside, one stress everywhere, at nodes and in elements."""
    A = np.array([[0.2, 0.1, 0.0], [-0.05, 0.1, 0.15], [0.0, 0.1, -0.1]])
    skin = scenes.skin(X)
    step = Step(dt=1.0, count=1, newton=scenes.tight(dtol=1e-10), conditions=scenes.prescribe(skin, X[skin] @ A.T, 0))
    keep = Run(problem(SOLIDS[0], isochoric, step))
    assert keep.solve().converged
    np.testing.assert_allclose(keep.state.u, X @ A.T, atol=1e-10)
    work = keep.groups[0].physics
    for s in (work.s.reshape(-1, 6), work.sn):
        np.testing.assert_allclose(s, np.broadcast_to(work.s[0, 0], s.shape), atol=1e-9)


@pytest.mark.parametrize("isochoric", [False, True])
def test_turned_forces(isochoric: bool) -> None:
    """Forces turn with the body, and balance: no sum, no moment."""
    from febkit.solver.quaternions import matrix, of_vector

    u, Q = motion(0.1), matrix(of_vector(np.array([0.4, -0.7, 1.1])))
    s = deformed(SOLIDS[1], isochoric, u)
    s.residual()
    f = s.state.reaction.copy()
    x = X + u
    turned = deformed(SOLIDS[1], isochoric, x @ Q.T - X)
    turned.state.d[:] = x @ Q.T - X
    turned.update()
    turned.residual()
    size = np.abs(f).max()
    np.testing.assert_allclose(turned.state.reaction, f @ Q.T, atol=1e-12 * size)
    np.testing.assert_allclose(f.sum(axis=0), 0.0, atol=1e-12 * size)
    np.testing.assert_allclose(np.cross(x, f).sum(axis=0), 0.0, atol=1e-12 * size)


def test_a_bending_bar_does_not_lock() -> None:
    """Nearly incompressible: softer by far than elements of constant pressure."""
    nodes, hexes = scenes.grid((8, 2, 2), (6.0, 1.0, 1.0))
    points, tets = scenes._split("tet4", nodes, hexes)
    held, end = np.flatnonzero(points[:, 0] < 1e-9), np.flatnonzero(points[:, 0] > 6 - 1e-9)
    from febkit.solver.loads.nodal import NodalForce
    from febkit.solver.values import Constant

    push = NodalForce(end, points[end], value=(Constant(0.0), Constant(0.0), Constant(0.001)))
    tips = []
    for p in (physics.load("ut4")(0.05, True), physics.default()):
        held_there = [Fixed(c, held) for c in range(3)]
        step = Step(dt=1.0, count=1, newton=scenes.tight(dtol=1e-8), conditions=held_there, loads=[push])
        block = Block("bar", "tet4", tets, np.arange(len(tets)), NeoHookean(10.0, 0.499), p)
        r = run(Problem(points, [block], [step]))
        assert r.converged, r.reason
        tips.append(r.state.u[end, 2].mean())
    exact = 0.001 * len(end) * 6.0**3 / (3 * 10.0 / 12)
    assert tips[0] == pytest.approx(exact, rel=0.3) and tips[1] < 0.4 * tips[0]


SOLID = '<material id="1" name="m" type="neo-Hookean"><density>1</density><E>1</E><v>0.3</v></material>'


def test_what_has_no_nodal_stress(tmp_path: Path) -> None:
    domain = '<SolidDomain name="cube" mat="m" type="ut4-solid"/>'
    content = cube.text(SOLID).replace('<SolidDomain name="cube" mat="m"/>', domain)
    with pytest.raises(InputError, match="takes tet4, not hex8"):
        cube.problem(tmp_path, content)
    five = ("1,2,4,5", "2,3,4,7", "5,7,6,2", "5,8,7,4", "2,4,5,7")
    tets = "".join(f'<elem id="{k}">{e}</elem>' for k, e in enumerate(five, 1))
    content = content.replace('type="hex8"', 'type="tet4"').replace('<elem id="1">1,2,3,4,5,6,7,8</elem>', tets)
    assert cube.problem(tmp_path, content).blocks[0].physics.name == "ut4"
    dynamic = content.replace("STATIC", "DYNAMIC")
    assert cube.problem(tmp_path, dynamic)
    with pytest.raises(InputError, match="forces within the step"):
        lower(cube.read(tmp_path, dynamic.replace("</step_size>", "</step_size><solver><rhoi>0.5</rhoi></solver>")))
    elastic = '<elastic type="neo-Hookean"><E>1</E><v>0.3</v></elastic>'
    old = f'<material id="1" name="m" type="viscoelastic"><g1>1</g1><t1>1</t1>{elastic}</material>'
    with pytest.raises(InputError, match="with a memory"):
        cube.problem(tmp_path, content.replace(SOLID, old))
