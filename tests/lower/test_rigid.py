"""Rigid bodies whose motion is told: what their nodes do, and what is refused."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit.lower import lower
from febkit.lower.rigid import ZERO, Body, Motion
from febkit.model import Component, UnsupportedError
from febkit.solver.values import Constant

sys.path.insert(0, str(Path(__file__).parent))
import cube

SOFT = '<material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material>'
RIGID = '<material id="2" name="plate" type="rigid body"><density>1</density>{}</material>'
TOP = '<bc node_set="top" type="rigid"><rb>plate</rb></bc></Boundary>'
HELD = '<rigid_bc type="rigid_fixed"><rb>plate</rb>{}</rigid_bc>'
TURN = '<rigid_bc type="rigid_rotation"><rb>plate</rb><dof>Rw</dof><value lc="1">0.5</value></rigid_bc>'
PUSH = '<rigid_bc type="rigid_displacement"><rb>plate</rb><dof>z</dof><value lc="1">-0.1</value></rigid_bc>'
RAMP = """<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>
<points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>"""


def fixed(*dofs: str) -> str:
    return HELD.format("".join(f"<{d}_dof>1</{d}_dof>" for d in dofs))


def text(rigid: str, centre: str = "<center_of_mass>0.5,0.5,1</center_of_mass>") -> str:
    out = cube.text(SOFT + RIGID.format(centre), more=f"<Rigid>{rigid}</Rigid>{RAMP}")
    return out.replace("</Boundary>", TOP)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_motion_is_a_rotation_about_the_centre_and_a_shift(axis: int) -> None:
    angle, centre, shift = 0.7, np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.2, -0.3])
    turn = [Constant(angle) if k == axis else ZERO for k in range(3)]
    body = Body(Component("material"), centre, [Constant(x) for x in shift], turn)
    assert not body.free and body.axis == axis
    X = np.random.default_rng(1).normal(size=(5, 3))
    e = np.eye(3)[axis]
    r = X - centre
    rodrigues = r * np.cos(angle) + np.cross(e, r) * np.sin(angle) + np.outer(r @ e, e) * (1 - np.cos(angle))
    u = np.stack([Motion(body, k)(1.0, X) for k in range(3)], axis=1)
    np.testing.assert_allclose(X + u, centre + shift + rodrigues, atol=1e-14)


def test_nodes_of_a_body_turn_and_sink(tmp_path: Path) -> None:
    spec = fixed("Rx", "Ry", "Ru", "Rv") + PUSH + TURN
    result = febkit.solve(cube.read(tmp_path, text(spec)))
    assert result.converged, result.reason
    top = result.state.u[4:]
    c, s = np.cos(0.5), np.sin(0.5)
    X = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    expected = X @ np.array([[c, s], [-s, c]]) - X
    np.testing.assert_allclose(top[:, :2], expected, atol=1e-12)
    np.testing.assert_allclose(top[:, 2], -0.1)


def test_bodies_that_may_move_freely_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UnsupportedError, match=r'"plate" with free degrees of freedom \(z, Ru\)'):
        lower(cube.read(tmp_path, text(fixed("Rx", "Ry", "Rv", "Rw"))))
    with pytest.raises(UnsupportedError, match="several axes"):
        both = TURN + TURN.replace("Rw", "Ru") + fixed("Rx", "Ry", "Rz", "Rv")
        lower(cube.read(tmp_path, text(both)))
    with pytest.raises(UnsupportedError, match="rigid_euler"):
        lower(cube.read(tmp_path, text('<rigid_bc type="rigid_euler_angles"><rb>plate</rb></rigid_bc>')))


def test_the_centre_is_that_of_the_elements(tmp_path: Path) -> None:
    """A rigid cube on its own: no centre given, its elements' is (1/2, 1/2, 1/2); its nodes move, too."""
    content = text(fixed("Rx", "Ry", "Rz", "Ru", "Rv") + TURN, centre="")
    content = content.replace('<NodeSet name="base">', '<Elements type="hex8" name="block"><elem id="2">'
                              + ",".join(map(str, range(9, 17))) + '</elem></Elements><NodeSet name="base">')
    extra = "".join(
        f'<node id="{9 + k}">{x},{y},{z + 5}</node>' for k, (x, y, z) in enumerate(cube._NODES)
    )
    content = content.replace("</Nodes>", extra + "</Nodes>")
    content = content.replace("</MeshDomains>", '<SolidDomain name="block" mat="plate"/></MeshDomains>')
    model = cube.read(tmp_path, content)
    problem = lower(model)
    assert [b.name for b in problem.blocks] == ["cube"]
    motion = problem.steps[0].conditions[-1].value
    np.testing.assert_allclose(motion.body.centre, (0.5, 0.5, 5.5))
    result = febkit.solve(model, plotfile=tmp_path / "out.xplt")
    assert result.converged, result.reason
    u = result.state.u[8:]
    expected = np.hypot(0.5, 0.5) * 2 * np.sin(0.25)
    np.testing.assert_allclose(np.linalg.norm(u, axis=1), expected)
    assert float(febkit.open_results(tmp_path / "out.xplt").time[-1]) == 1.0
