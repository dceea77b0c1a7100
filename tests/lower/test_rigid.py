"""Rigid bodies of a file: what their nodes do, what acts on them, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit.lower import lower
from febkit.model import InputError, UnsupportedError
from helpers import cube

SOFT = '<material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material>'
RIGID = '<material id="2" name="plate" type="rigid body"><density>1</density>{}</material>'
TOP = '<bc node_set="top" type="rigid"><rb>plate</rb></bc></Boundary>'
HELD = '<rigid_bc type="rigid_fixed"><rb>plate</rb>{}</rigid_bc>'
TURN = '<rigid_bc type="rigid_rotation"><rb>plate</rb><dof>Rw</dof><value lc="1">0.5</value></rigid_bc>'
PUSH = '<rigid_bc type="rigid_displacement"><rb>plate</rb><dof>z</dof><value lc="1">-0.1</value></rigid_bc>'
FORCE = """<rigid_load type="rigid_force"><rb>plate</rb><dof>Rz</dof><value lc="1">0.1</value>
<load_type>LOAD</load_type></rigid_load>"""
JOINT = '<rigid_connector type="{}"><body_a>plate</body_a><body_b>plate</body_b>{}</rigid_connector>'
RAMP = """<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>
<points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>"""


def fixed(*dofs: str) -> str:
    return HELD.format("".join(f"<{d}_dof>1</{d}_dof>" for d in dofs))


def text(rigid: str, centre: str = "<center_of_mass>0.5,0.5,1</center_of_mass>") -> str:
    out = cube.text(SOFT + RIGID.format(centre), more=f"<Rigid>{rigid}</Rigid>{RAMP}")
    return out.replace("</Boundary>", TOP)


def test_nodes_of_a_body_turn_and_sink(tmp_path: Path) -> None:
    spec = fixed("Rx", "Ry", "Ru", "Rv") + PUSH + TURN
    result = febkit.solve(cube.read(tmp_path, text(spec)))
    assert result.converged, result.reason
    top = result.state.u[4:8]
    c, s = np.cos(0.5), np.sin(0.5)
    X = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    expected = X @ np.array([[c, s], [-s, c]]) - X
    np.testing.assert_allclose(top[:, :2], expected, atol=1e-12)
    np.testing.assert_allclose(top[:, 2], -0.1)


def test_what_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UnsupportedError, match='"plate" that turns as prescribed about some axes and freely'):
        lower(cube.read(tmp_path, text(fixed("Rx", "Ry", "Rv") + TURN)))
    target = FORCE.replace("LOAD", "TARGET")
    with pytest.raises(UnsupportedError, match="TARGET</load_type> of <rigid_load"):
        lower(cube.read(tmp_path, text(target)))
    strange = JOINT.format("rigid hinge", "<joint>0,0,0</joint>")
    with pytest.raises(UnsupportedError, match="rigid hinge"):
        lower(cube.read(tmp_path, text(strange)))
    multiplier = JOINT.format("rigid lock", "<laugon>LAGMULT</laugon><joint_origin>0,0,0</joint_origin>")
    with pytest.raises(UnsupportedError, match='LAGMULT</laugon> of <rigid_connector type="rigid lock">'):
        lower(cube.read(tmp_path, text(multiplier)))
    with pytest.raises(InputError, match='no rigid body material "cube"'):
        lower(cube.read(tmp_path, text(fixed("Rx").replace("plate", "cube"))))


def test_a_force_lifts_a_free_plate(tmp_path: Path) -> None:
    """The plate, free but for sliding and turning about z, is pulled by 0.1."""
    result = febkit.solve(cube.read(tmp_path, text(fixed("Rx", "Ry", "Rw") + FORCE)))
    assert result.converged, result.reason
    s = result.state
    assert s.reaction[4:8, 2].sum() == pytest.approx(0.1, abs=1e-6)
    np.testing.assert_allclose(s.d[4:8, 2], s.d[8, 2], atol=1e-9)
    assert s.d[8, 2] > 0.05


def test_conditions_loads_and_joints_name_the_rows_of_their_body(tmp_path: Path) -> None:
    given = """<rigid_bc type="rigid_rotation_vector"><rb>2</rb><vx>0.1</vx><vy lc="1">0.2</vy></rigid_bc>
    <rigid_ic type="initial_rigid_angular_velocity"><rb>plate</rb><value>1,2,3</value></rigid_ic>
    <rigid_load type="rigid_moment"><rb>plate</rb><dof>Rv</dof><value>2</value></rigid_load>
    <rigid_load type="rigid_follower_force"><rb>plate</rb><insertion>1,1,1</insertion><force>0,0,1</force></rigid_load>
    """ + JOINT.format(
        "rigid revolute joint",
        "<joint_origin>0,0,0</joint_origin><rotation_axis>0,0,2</rotation_axis><prescribed_rotation>1"
        '</prescribed_rotation><rotation lc="1">0.5</rotation><force_penalty>7</force_penalty>',
    )
    problem = lower(cube.read(tmp_path, text(given)))
    conditions = problem.common.conditions[-3:]
    assert [(c.column, c.nodes.tolist()) for c in conditions] == [(k, [9]) for k in range(3)]
    assert [float(c.value(0.5, np.zeros((1, 3)))[0]) for c in conditions] == [0.1, 0.1, 0.0]
    start = problem.common.initial
    assert [(c.column, c.nodes.tolist(), c.velocity) for c in start] == [(k, [9], True) for k in range(3)]
    moment, follower = problem.common.loads
    assert (moment.row, moment.axis) == (8, 1)
    np.testing.assert_allclose(follower.arm, (0.5, 0.5, 0.0))
    joint = problem.common.connectors[0]
    assert (joint.a, joint.b, joint.force_penalty, joint.prescribed_rotation) == (0, 0, 7.0, True)
    np.testing.assert_allclose(joint.axes, [(0, 0, 1), (1, 0, 0), (0, 1, 0)], atol=1e-15)


def test_euler_angles(tmp_path: Path) -> None:
    spec = '<rigid_bc type="rigid_euler_angles"><rb>plate</rb><Ez lc="1">90</Ez></rigid_bc>' + fixed("Rx", "Ry", "Rz")
    result = febkit.solve(cube.read(tmp_path, text(spec)))
    assert result.converged, result.reason
    np.testing.assert_allclose(result.state.u[4:8], [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)], atol=1e-12)


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
    np.testing.assert_allclose(problem.bodies[0].centre, (0.5, 0.5, 5.5))
    result = febkit.solve(model, plotfile=tmp_path / "out.xplt")
    assert result.converged, result.reason
    u = result.state.u[8:16]
    expected = np.hypot(0.5, 0.5) * 2 * np.sin(0.25)
    np.testing.assert_allclose(np.linalg.norm(u, axis=1), expected)
    assert float(febkit.open_results(tmp_path / "out.xplt").time[-1]) == 1.0


def test_materials_whose_parts_share_a_node_are_one_body(tmp_path: Path) -> None:
    two = RIGID.format("") + RIGID.replace('id="2" name="plate"', 'id="3" name="rim"').format("")
    content = cube.text(SOFT + two, more=f"<Rigid>{fixed('Rx').replace('plate', 'rim')}</Rigid>{RAMP}")
    blocks = ""
    for name, e, ids in (("block", 2, range(9, 17)), ("ring", 3, (13, 14, 15, 16, 17, 18, 19, 20))):
        blocks += f'<Elements type="hex8" name="{name}"><elem id="{e}">{",".join(map(str, ids))}</elem></Elements>'
    nodes = [(x, y, z + 5) for x, y, z in cube._NODES] + [(x, y, z + 6) for x, y, z in cube._NODES[4:]]
    extra = "".join(f'<node id="{9 + k}">{x},{y},{z}</node>' for k, (x, y, z) in enumerate(nodes))
    content = content.replace("</Nodes>", extra + "</Nodes>", 1).replace("<NodeSet", blocks + "<NodeSet", 1)
    parts = '<SolidDomain name="block" mat="plate"/><SolidDomain name="ring" mat="rim"/></MeshDomains>'
    problem = lower(cube.read(tmp_path, content.replace("</MeshDomains>", parts)))
    (body,) = problem.bodies
    assert (body.name, body.mass) == ("plate", pytest.approx(2.0))
    np.testing.assert_allclose(body.centre, (0.5, 0.5, 6.0))
    assert body.nodes.tolist() == list(range(8, 20))
    assert problem.common.conditions[-1].nodes.tolist() == [20]
