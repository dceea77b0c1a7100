"""Prestrain gradients given element by element."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit.model import UnsupportedError
from febkit.solver.points import Points
from febkit.solver.result import Result
from febkit.solver.run import run
from helpers import cube

F0 = (1.1, 0.02, 0.0, 0.03, 0.9, 0.01, 0.0, 0.04, 1.05)
MATERIAL = """<material id="1" name="m" type="prestrain elastic">
<elastic type="neo-Hookean"><E>1</E><v>0.3</v></elastic>
<prestrain type="prestrain gradient"><ramp>0.5</ramp>{}</prestrain></material>"""


def gradient(folder: Path, leaf: str, more: str = "") -> np.ndarray:
    solid = cube.problem(folder, cube.text(MATERIAL.format(leaf), more=more)).blocks[0].solid
    pts = Points(np.eye(3)[None], np.ones(1), np.zeros((1, 3)), np.zeros(1, int))
    return np.asarray(solid.prestrain.gradient(pts)[0])


def test_a_map_gives_the_nine_numbers_of_each_element(tmp_path: Path) -> None:
    numbers = ",".join(map(str, F0))
    element = f'<e lid="1">{numbers}</e>'
    data = f'<MeshData><ElementData name="F0_map" elem_set="cube" data_type="mat3">{element}</ElementData></MeshData>'
    expected = 0.5 * np.eye(3) + 0.5 * np.reshape(F0, (3, 3))
    np.testing.assert_allclose(gradient(tmp_path, '<F0 type="map">F0_map</F0>', data), expected)
    np.testing.assert_allclose(gradient(tmp_path, f"<F0>{numbers}</F0>"), expected)


CONSTRAINT = """<Constraints><constraint type="{}"><tolerance>1e-9</tolerance>{}</constraint></Constraints>"""
ALONG = """<material id="1" name="m" type="prestrain elastic"><elastic type="coupled trans-iso Mooney-Rivlin"><c1>1</c1>
<c3>1</c3><c4>5</c4><c5>10</c5><lam_max>1.2</lam_max><k>10</k><fiber type="vector">1,0,0</fiber></elastic>
<prestrain type="in-situ stretch"><stretch>1.1</stretch></prestrain></material>"""
HELD = """<bc node_set="@surface:left" type="zero displacement"><x_dof>1</x_dof></bc>
<bc node_set="@surface:front" type="zero displacement"><y_dof>1</y_dof></bc>
<bc node_set="base" type="zero displacement"><z_dof>1</z_dof></bc>"""
SIDES = '<Surface name="left"><quad4 id="1">1,4,8,5</quad4></Surface><Surface name="front"><quad4 id="1">1,2,6,5</quad4></Surface>'  # noqa: E501
TIGHT = "<time_steps>1</time_steps><step_size>1</step_size><solver type=\"solid\"><dtol>1e-9</dtol></solver>"


def solved(folder: Path, material: str, constraint: str, inside: str = "") -> Result:
    content = cube.text(material, more=CONSTRAINT.format(constraint, inside), control=TIGHT)
    start, end = content.index("<Boundary>"), content.index("</Boundary>")
    content = content[:start] + f"<Boundary>{HELD}" + content[end:].replace("</Mesh>", "")
    return run(cube.problem(folder, content.replace("</Mesh>", f"{SIDES}</Mesh>")))


def test_a_corrected_prestrain_leaves_the_shape(tmp_path: Path) -> None:
    """What the given prestrain would deform, its correction takes: F0 = Fc F_given ends as the identity's stress."""
    gradient = MATERIAL.format("<F0>1.1,0,0,0,0.9,0,0,0,1.05</F0>").replace("<ramp>0.5", "<ramp>1")
    free = solved(tmp_path, gradient, "prestrain", "<update>0</update>")
    result = solved(tmp_path, gradient, "prestrain")
    assert free.converged and result.converged
    assert np.abs(free.state.u).max() > 0.04
    np.testing.assert_allclose(result.state.u, 0.0, atol=1e-7)


def test_a_stretch_is_corrected_by_that_of_the_fiber(tmp_path: Path) -> None:
    """A free cube prestretched by 1.1 shortens to l = 1/1.1; corrected once, by 1/l, it shortens as much again."""
    for inside, l in (("<update>0</update>", 1.1**-1), ("", 1.1**-2), ("<max_stretch>0.5</max_stretch>", 1.1**-1)):
        result = solved(tmp_path, ALONG, "in-situ stretch", f"<max_iters>1</max_iters>{inside}")
        assert result.converged
        np.testing.assert_allclose(1.0 + result.state.u[[1, 2, 5, 6], 0], l, rtol=1e-7)
        np.testing.assert_allclose(1.0 + result.state.u[4:, 2], l**-0.5, rtol=1e-7)


def test_a_stretch_that_is_not_isochoric(tmp_path: Path) -> None:
    solid = ALONG.replace("</stretch>", "</stretch><isochoric>0</isochoric>")
    result = solved(tmp_path, solid, "in-situ stretch", "<max_iters>1</max_iters><isochoric>0</isochoric>")
    np.testing.assert_allclose(1.0 + result.state.u[4:, 2], 1.0, rtol=1e-7)


def test_other_tags_are_refused(tmp_path: Path) -> None:
    content = cube.text(ALONG, more=CONSTRAINT.format("prestrain", "<isochoric>1</isochoric>"))
    with pytest.raises(UnsupportedError, match=r'<isochoric> of <constraint type="prestrain">'):
        cube.problem(tmp_path, content)
