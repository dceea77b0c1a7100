"""<constraint>s of normal displacements, enclosed volumes and distances."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from febkit.model import InputError, UnsupportedError
from febkit.solver.loads.enclosed_volume import EnclosedVolume
from febkit.solver.loads.held_normals import HeldNormals
from febkit.solver.loads.node_distance import NodeDistance
from helpers import cube

SOLID = '<material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material>'
BODY = '<material id="2" name="stiff" type="rigid body"><density>1</density></material>'
TOP = '<Surface name="topS"><quad4 id="1">5,6,7,8</quad4></Surface>'


def load(folder: Path, type_: str, inside: str, surface: str = 'surface="topS"') -> Any:
    spec = f'<Constraints><constraint type="{type_}" {surface}>{inside}</constraint></Constraints>'
    text = cube.text(SOLID, more=spec).replace("</Mesh>", f"{TOP}</Mesh>")
    (found,) = cube.problem(folder, text).common.loads
    return found


@pytest.mark.parametrize("type_", ["symmetry plane", "fixed normal displacement"])
def test_a_plane_is_read(tmp_path: Path, type_: str) -> None:
    inside = "<laugon>AUGLAG</laugon><tol>0.2</tol><penalty type='math'>9*t</penalty><maxaug>7</maxaug>"
    plane = load(tmp_path, type_, inside)
    assert isinstance(plane, HeldNormals) and plane.at.tolist() == [4, 5, 6, 7]
    assert plane.nodes.tolist() == [[n] * 3 for n in (4, 5, 6, 7)] and plane.columns[0].tolist() == [0, 1, 2]
    assert (plane.tolerance, plane.maxaug, plane.laugon) == (0.2, 7, 1)
    assert plane.penalty(0.5, np.zeros((1, 3)))[0] == 4.5  # type: ignore[operator]


def test_nodes_that_a_body_carries_are_left_out(tmp_path: Path) -> None:
    far = "".join(f'<node id="{k + 9}">{x},{y},{z + 5}</node>' for k, (x, y, z) in enumerate(cube._NODES))
    text = cube.text(SOLID + BODY, more='<Constraints><constraint type="symmetry plane" surface="topS"/></Constraints>')
    for end, more in {
        "</Nodes>": far,
        "<NodeSet": '<Elements type="hex8" name="far"><elem id="2">9,10,11,12,13,14,15,16</elem></Elements>',
        "</Mesh>": f'{TOP}<NodeSet name="one">6</NodeSet>',
        "</MeshDomains>": '<SolidDomain name="far" mat="stiff"/>',
        "</Boundary>": '<bc type="rigid" node_set="one"><rb>stiff</rb></bc>',
    }.items():
        text = text.replace(end, more + end, 1)
    (plane,) = cube.problem(tmp_path, text).common.loads
    assert plane.at.tolist() == [4, 6, 7]


def test_a_volume_is_read(tmp_path: Path) -> None:
    held = load(tmp_path, "volume", "<laugon>1</laugon><augtol>0.2</augtol><penalty>-9</penalty>")
    assert isinstance(held, EnclosedVolume) and held.laugon and held.tolerance == 0.2
    assert held.surface[0].element.rule == "nodal"
    assert held.penalty(0.5, np.zeros((1, 3)))[0] == -9.0  # type: ignore[operator]


def test_a_distance_is_read(tmp_path: Path) -> None:
    held = load(tmp_path, "node distance", "<node>7,2</node><penalty>3</penalty><target>0.5</target>", "")
    assert isinstance(held, NodeDistance) and held.nodes.tolist() == [6, 1]
    assert held.relative and not held.augments and (held.maxaug, held.tolerance) == (10, 0.01)


@pytest.mark.parametrize(("type_", "inside", "surface", "says"), [
    ("node distance", "<node>7</node>", "", "must be 2 numbers"),
    ("node distance", "<penalty>1</penalty>", "", "<node>"),
    ("node distance", "<node>7,70</node>", "", "there is no node 70"),
    ("symmetry plane", "<laugon>LAGMULT</laugon>", 'surface="topS"', "LAGMULT"),
    ("symmetry plane", "<shell_bottom>1</shell_bottom>", 'surface="topS"', "shell_bottom"),
    ("fixed normal displacement", "<shell_bottom>1</shell_bottom>", 'surface="topS"', "a facet of .* is no shell"),
    ("fixed normal displacement", "", 'surface="tapS"', 'there is no surface "tapS".*topS'),
    ("volume", "", "", "there is no surface"),
    ("volume", "<tol>1</tol>", 'surface="topS"', "<tol>"),
])  # fmt: skip
def test_faults_are_named(tmp_path: Path, type_: str, inside: str, surface: str, says: str) -> None:
    with pytest.raises((InputError, UnsupportedError), match=says) as e:
        load(tmp_path, type_, inside, surface)
    assert e.value.where is not None and e.value.where.line
