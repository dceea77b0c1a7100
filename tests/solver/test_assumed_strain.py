"""Shells of assumed and enhanced strains: tangents, patch, rigid motion, bending, and FEBio's own answers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit.lower import lower
from febkit.model import InputError
from febkit.solver import physics
from febkit.solver.loads.nodal import NodalForce
from febkit.solver.problem import Block, Fixed, Prescribed, Problem, Step
from febkit.solver.quaternions import matrix, of_vector
from febkit.solver.run import Run
from febkit.solver.shells import Shell, thicken
from febkit.solver.solids.mooney_rivlin import MooneyRivlin
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.system import System
from febkit.solver.values import Constant, Expression
from helpers import blocks, scenes

VARIED = NeoHookean(Expression(lambda X, Y, Z, t: 20.0 + X + 0.5 * Y * Z), 0.3)
BOTH = pytest.mark.parametrize("enhanced", [False, True])


def sheet(n: tuple[int, int], size: tuple[float, float], h: float, distort: float = 0.0, curve: float = 0.0) -> Any:
    """Nodes, back nodes of the mesh's nodes, and elements of a sheet, distorted inside, curved as a parabola."""
    x, y = (np.linspace(0.0, s, k + 1) for s, k in zip(size, n))
    X = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((n[0] + 1, n[1] + 1))], axis=-1).reshape(-1, 3)
    inside = ((X[:, :2] > 1e-9) & (X[:, :2] < np.array(size) - 1e-9)).all(axis=1)
    X[inside, :2] += np.random.default_rng(5).uniform(-distort, distort, (inside.sum(), 2))
    X[:, 2] = curve * (X[:, 0] ** 2 + 0.5 * X[:, 0] * X[:, 1])
    k = np.arange(len(X)).reshape(n[0] + 1, n[1] + 1)
    conn = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
    made = thicken(X, [Shell("quad4", conn, np.full(conn.shape, h))])
    return made.X, made.back[: len(X)], made.shells[0]


def problem(X: Any, conn: Any, solid: Any, enhanced: bool | None, step: Step) -> Problem:
    p = physics.default() if enhanced is None else physics.load("assumed strain")(enhanced)
    return Problem(X, [Block("sheet", "shell_quad4", conn, np.arange(len(conn)) + 1, solid, p)], [step])


def deformed(X: Any, conn: Any, solid: Any, enhanced: bool, u: Any) -> System:
    step = Step(newton=scenes.tight(), conditions=[Fixed(c, np.flatnonzero(X[:, 0] < 1e-9)) for c in range(3)])
    r = Run(problem(X, conn, solid, enhanced, step))
    r._set_up()
    s = System(r.problem, step, r.groups, r.state, r.schedule)
    r.state.d[:] = u
    s.update()
    return s


@BOTH
@pytest.mark.parametrize("solid", [NeoHookean(20.0, 0.3), MooneyRivlin(3.0, 0.5, k=100.0), VARIED])
def test_tangent(solid: Any, enhanced: bool) -> None:
    X, _, conn = sheet((2, 2), (2.0, 2.0), 0.2, 0.2, 0.1)
    u = 0.02 * np.random.default_rng(1).normal(size=X.shape) * (X[:, :1] > 1e-9)
    s = deformed(X, conn, solid, enhanced, u)
    K, d, zero, h = blocks.assembled(s), s.gather(s.state.d), np.zeros(s.eqs.n), 1e-6
    exact = np.empty_like(K)
    for i in range(s.eqs.n):
        e = zero.copy()
        e[i] = h
        s.set(d, zero, e, s.state.d)
        up = s.residual()
        s.set(d, zero, -e, s.state.d)
        exact[:, i] = -(up - s.residual()) / (2 * h)
    assert s.symmetric
    np.testing.assert_allclose(K, exact, atol=2e-7 * np.abs(exact).max())


@BOTH
def test_patch(enhanced: bool) -> None:
    """A flat sheet of distorted elements stretched, sheared and thinned: one stress everywhere."""
    X, _, conn = sheet((3, 3), (3.0, 2.0), 0.1, 0.25)
    A = np.array([[0.1, 0.05, 0.0], [-0.02, 0.05, 0.0], [0.0, 0.0, -0.06]])
    edge = np.flatnonzero((np.abs(X[:, 0] % 3.0) < 1e-9) | (np.abs(X[:, 1] % 2.0) < 1e-9))
    assert 0 < len(edge) < len(X)
    step = Step(dt=1.0, count=1, newton=scenes.tight(dtol=1e-9), conditions=scenes.prescribe(edge, X[edge] @ A.T, 0))
    # the thickness of the nodes inside is free: held as the strain has it, in balance with the same stress by a load
    inside = np.setdiff1d(np.arange(len(X)), edge)
    step.conditions += scenes.prescribe(inside, X[inside] @ A.T[:, 2:], 2)
    r = Run(problem(X, conn, NeoHookean(20.0, 0.3), enhanced, step))
    assert r.solve().converged
    np.testing.assert_allclose(r.state.u, X @ A.T, atol=1e-9)
    s = r.groups[0].physics.s.reshape(-1, 6)
    np.testing.assert_allclose(s, np.broadcast_to(s[0], s.shape), atol=1e-9 * np.abs(s).max())
    if enhanced:
        np.testing.assert_allclose(r.groups[0].physics.alpha, 0.0, atol=1e-12)


@BOTH
def test_turned_forces(enhanced: bool) -> None:
    """Forces turn with the sheet and balance; a rigid motion makes none."""
    X, _, conn = sheet((2, 2), (2.0, 2.0), 0.2, 0.2, 0.1)
    Q, solid = matrix(of_vector(np.array([0.4, -0.7, 1.1]))), NeoHookean(20.0, 0.3)
    u = 0.02 * np.random.default_rng(1).normal(size=X.shape)
    s = deformed(X, conn, solid, enhanced, u)
    s.residual()
    f, x = s.state.reaction.copy(), X + u
    s.state.d[:] = x @ Q.T + 1.0 - X
    s.update()
    s.residual()
    np.testing.assert_allclose(s.state.reaction, f @ Q.T, atol=1e-10 * np.abs(f).max())
    np.testing.assert_allclose(f.sum(axis=0), 0.0, atol=1e-10 * np.abs(f).max())
    np.testing.assert_allclose(np.cross(x, f).sum(axis=0), 0.0, atol=1e-9 * np.abs(f).max())
    s.state.d[:] = X @ Q.T - 2.0 - X
    s.update()
    s.residual()
    np.testing.assert_allclose(s.state.reaction, 0.0, atol=1e-11)


def tip(enhanced: bool | None, v: float) -> float:
    """Deflection of a strip of length 10, width 1 and thickness 0.05 under a force, over F L^3 / 3 E I."""
    X, _, conn = sheet((10, 1), (10.0, 1.0), 0.05)
    held, end = (np.flatnonzero(np.abs(X[:, 0] - x) < 1e-9) for x in (0.0, 10.0))
    F = 1e-8 / len(end)
    push = NodalForce(end, X[end], value=(Constant(0.0), Constant(0.0), Constant(F)))
    conditions: list[Fixed | Prescribed] = [Fixed(c, held) for c in range(3)]
    step = Step(dt=1.0, count=1, newton=scenes.tight(dtol=1e-6), conditions=conditions, loads=[push])
    r = Run(problem(X, conn, NeoHookean(100.0, v), enhanced, step))
    result = r.solve()
    assert result.converged, result.reason
    return float(r.state.u[end, 2].mean() / (1e-8 * 10.0**3 / (3 * 100.0 * 0.05**3 / 12)))


def test_a_thin_strip_bends() -> None:
    """Without Poisson's ratio as a beam; with it between beam and plate, stiffer where nothing is enhanced."""
    assert tip(True, 0.0) == pytest.approx(1.0, rel=5e-3) and tip(False, 0.0) == pytest.approx(1.0, rel=5e-3)
    assert 1.0 - 0.3**2 < tip(True, 0.3) < 1.0
    assert tip(False, 0.3) < tip(True, 0.3) - 0.05
    assert tip(True, 0.0) > 0.99 > tip(None, 0.0)


MODEL = """<febio_spec version="4.0"><Module type="solid"/>
<Control><analysis>STATIC</analysis><time_steps>2</time_steps><step_size>0.5</step_size><solver type="solid">
<dtol>1e-9</dtol><etol>1e-16</etol><lstol>0</lstol><min_residual>1e-24</min_residual><max_refs>50</max_refs>
<qn_method type="BFGS"><max_ups>0</max_ups></qn_method>{solver}</solver></Control>
<Material>{material}</Material>
<Mesh><Nodes name="all"><node id="1">0,0,0</node><node id="2">1.1,0,0.1</node><node id="3">2,0,0.3</node>
<node id="4">0,1,0.1</node><node id="5">0.9,1.1,0.3</node><node id="6">2,1,0.6</node></Nodes>
{elements}
<NodeSet name="held">1,4</NodeSet><NodeSet name="end">3</NodeSet></Mesh>
<MeshDomains><ShellDomain name="p" mat="m" type="{type}"><shell_thickness>0.15</shell_thickness></ShellDomain>
</MeshDomains>
<Boundary><bc type="zero displacement" node_set="held"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
<bc type="zero shell displacement" node_set="held"><sx_dof>1</sx_dof><sy_dof>1</sy_dof><sz_dof>1</sz_dof></bc>
</Boundary>
<Loads><nodal_load type="nodal_force" node_set="end"><value lc="1">0.005,0.01,-0.015</value></nodal_load></Loads>
<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>
<points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData></febio_spec>"""
NEO = '<material id="1" name="m" type="neo-Hookean"><density>1</density><E>100</E><v>0.3</v></material>'
QUADS = '<Elements type="quad4" name="p"><elem id="1">1,2,5,4</elem><elem id="2">2,3,6,5</elem></Elements>'
# displacements of nodes 2, 3, 5, 6 and stresses xx yy zz xy of both elements by FEBio 4.11
ANSWERS = {
    "elastic-shell-eas": (
        [[0.0165289854661, 0.0676794685011, -0.460736259925], [-0.14255669133, 0.258061440794, -1.2126764097],
         [0.0610728275908, 0.000409993833408, -0.223995362299], [0.0292961596241, 0.154565550276, -1.00620686561]],
        [[0.02185970, -0.21225705, -0.03863580, 0.05998430], [-0.00227546, 0.02746233, 0.09301900, 0.05588570]],
    ),
    "elastic-shell-ans": (
        [[0.0231340343191, 0.0631069068049, -0.415452218624], [-0.0997204986719, 0.237290475124, -1.12130222656],
         [0.0581333660608, -0.00654622405147, -0.191951920227], [0.0567656967749, 0.129866825233, -0.903580414625]],
        [[0.02957499, -0.22776779, -0.06400811, 0.06097913], [-0.00320165, 0.01545615, 0.08274152, 0.06010253]],
    ),
}  # fmt: skip


def text(kind: str, material: str = NEO, elements: str = QUADS, solver: str = "") -> str:
    return MODEL.format(type=kind, material=material, elements=elements, solver=solver)


@pytest.mark.parametrize("kind", ANSWERS)
def test_febios_answers(tmp_path: Path, kind: str) -> None:
    (tmp_path / "m.feb").write_text(text(kind))
    r = Run(lower(febkit.read(tmp_path / "m.feb")))
    assert r.solve().converged
    u, s = ANSWERS[kind]
    np.testing.assert_allclose(r.state.u[[1, 2, 4, 5]], u, rtol=1e-9)
    np.testing.assert_allclose(r.groups[0].physics.s.mean(axis=1)[:, [0, 1, 2, 3]], s, atol=1e-8)


TRIS = '<Elements type="tri3" name="p"><elem id="1">1,2,4</elem></Elements>'
OLD = ('<material id="1" name="m" type="viscoelastic"><g1>1</g1><t1>1</t1><elastic type="neo-Hookean"><E>1</E><v>0</v>'
       "</elastic></material>")  # fmt: skip


@pytest.mark.parametrize(("changes", "says"), [
    ({"elements": TRIS}, 'type="elastic-shell-eas"> of tri3'),
    ({"material": OLD}, "with a memory"),
    ({"solver": "<rhoi>0.5</rhoi>"}, "forces within the step"),
])  # fmt: skip
def test_what_is_refused(tmp_path: Path, changes: dict[str, str], says: str) -> None:
    content = text("elastic-shell-eas", **changes)
    (tmp_path / "m.feb").write_text(content.replace("STATIC", "DYNAMIC"))
    with pytest.raises(InputError, match=says):
        lower(febkit.read(tmp_path / "m.feb"))


def test_three_field_shells_are_augmented(tmp_path: Path) -> None:
    """A sheet of nearly incompressible elements: the augmented volume is nearer to 1."""
    rubber = '<material id="1" name="m" type="Mooney-Rivlin"><density>1</density><k>50</k><c1>20</c1></material>'
    J = []
    for more in ("", "<laugon>1</laugon><atol>0.001</atol><maxaug>30</maxaug>"):
        content = text("three-field-shell", rubber).replace("<shell_thickness>", f"{more}<shell_thickness>")
        (tmp_path / "m.feb").write_text(content)
        r = Run(lower(febkit.read(tmp_path / "m.feb")))
        assert r.solve().converged
        J.append(np.abs(r.groups[0].physics.eJ - 1.0).max())
    assert J[1] < 0.05 * J[0]
