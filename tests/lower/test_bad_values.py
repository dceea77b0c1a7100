"""Values that are none: each is refused with its tag, its line and what would be right, and never by a traceback."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from febkit.feb import read
from febkit.lower import lower
from febkit.model import InputError, Model
from helpers import cube, forked

SOLID = '<material id="1" name="m" type="neo-Hookean"><E>{E}</E><v>0.3</v>{more}</material>'
FIBER = """<material id="1" name="m" type="coupled trans-iso Mooney-Rivlin"><c1>1</c1><c2>0</c2><c3>1</c3><c4>1</c4>
<c5>1</c5><lam_max>1.1</lam_max><k>10</k>{}</material>"""
SCHEME = """<material id="1" name="m" type="continuous fiber distribution">
<fibers type="fiber-exp-pow"><alpha>0</alpha><beta>2</beta><ksi>1</ksi></fibers>
<distribution type="spherical"/><scheme type="fibers-3d-gauss"><nph>5</nph><nth>{}</nth></scheme></material>"""
DAMPED = SOLID.format(E=1, more="")
BOUNDARY = '<bc type="prescribed displacement" node_set="top"><dof>z</dof><value lc="1">0.1</value></bc>'
CURVE = """<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><extend>CONSTANT</extend>
<points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>"""


def control(text: str) -> str:
    return cube.text(DAMPED, control=text)


def material(text: str) -> str:
    return cube.text(text)


def boundary(old: str, new: str) -> str:
    return cube.text(DAMPED, more=CURVE).replace("</Boundary>", BOUNDARY.replace(old, new) + "</Boundary>")


def section(text: str) -> str:
    return cube.text(DAMPED, more=text)


STEPS = "<time_steps>1</time_steps><step_size>1</step_size>"
DISCRETE = """<Discrete><discrete_material id="1" name="s" type="nonlinear spring">{}</discrete_material>
<discrete dmat="1" discrete_set="d"/></Discrete>"""
PENALTY = """<Constraints><constraint type="linear constraint"><laugon>{}</laugon><tol>0.1</tol><penalty>1</penalty>
<linear_constraint><node {}>1</node><node id="2" bc="x">-1</node></linear_constraint></constraint></Constraints>"""
TIE = """<bc type="linear constraint"><node>{}</node><dof>x</dof><offset>0</offset>
<child_dof><node>6</node><dof>{}</dof><value>1</value></child_dof></bc></Boundary>"""
BAD = {
    "E nan": (material(SOLID.format(E="nan", more="")), "<E> must be a finite number, not 'nan'"),
    "E inf": (material(SOLID.format(E="-inf", more="")), "<E> must be a finite number, not '-inf'"),
    "E 1e309": (material(SOLID.format(E="1e309", more="")), "<E> must be a number that a double holds"),
    "E 1_0": (material(SOLID.format(E="1_0", more="")), "1_0"),
    "E 1/0": (material(SOLID.format(E="1/(2-2)", more="")), r'the formula "1/\(2-2\)" gives inf'),
    "fiber nan": (material(FIBER.format('<fiber type="vector">nan,0,0</fiber>')), "<fiber.*finite number, not 'nan'"),
    "fiber text": (material(FIBER.format('<fiber type="local">a,b</fiber>')), "<fiber.*must be a number, not 'a'"),
    "fiber 99": (material(FIBER.format('<fiber type="local">1,99</fiber>')), "has nodes 1 to 8, not 99"),
    "fiber itself": (material(FIBER.format('<fiber type="local">2,2</fiber>')), "two different nodes"),
    "axes text": (material(SOLID.format(E=1, more='<mat_axis type="local">x,2,3</mat_axis>')), "must be a number"),
    "axes bent": (
        material(SOLID.format(E=1, more='<mat_axis type="const">1,0,0,0,1,0,0,0.1,1</mat_axis>')), "must be a rotation"
    ),
    "pressure model": (
        material('<material id="1" name="m" type="Mooney-Rivlin"><c1>1</c1><c2>0</c2><k>9</k>'
                 "<pressure_model>nike</pressure_model></material>"),
        "<pressure_model> must be one of default, nike3d, .*; did you mean \"nike3d\"",
    ),
    "steps inf": (control("<time_steps>inf</time_steps><step_size>1</step_size>"), "<time_steps> must be a finite"),
    "steps 1.5": (control("<time_steps>1.5</time_steps><step_size>1</step_size>"), "<time_steps> must be an integer"),
    "steps 1e12": (control("<time_steps>1e12</time_steps><step_size>1</step_size>"), "<time_steps> must be at most 21"),
    "no steps": (control("<time_steps>0</time_steps>"), "<time_steps> must be at least 1"),
    "no end": (control("<time_steps>-1</time_steps><step_size>1</step_size>"), "<final_time> must be .* more than 0"),
    "too long": (control("<time_steps>1000</time_steps><step_size>1e306</step_size>"), "end time inf is too large"),
    "analysis": (control(STEPS.replace("><", "><", 1) + "<analysis>STATIK</analysis>"), "did you mean \"static\""),
    "plot range": (control(STEPS + "<plot_range>0,inf</plot_range>"), "<plot_range> must be a finite number"),
    "plot level": (control(STEPS + "<plot_level>PLOT_MAJOR</plot_level>"), "did you mean \"plot_major_itrs\""),
    "stride": (control(STEPS + "<plot_stride>0</plot_stride>"), "<plot_stride> must be at least 1"),
    "rtol": (control(STEPS + '<solver type="solid"><rtol>nan</rtol></solver>'), "<rtol> must be a finite number"),
    "symmetry": (
        control(STEPS + '<solver type="solid"><symmetric_stiffness>maybe</symmetric_stiffness></solver>'),
        "<symmetric_stiffness> must be one of symmetric, ",
    ),
    "lc text": (boundary('lc="1"', 'lc="one"'), 'lc="one" of <value> must be an id'),
    "lc 9": (boundary('lc="1"', 'lc="9"'), "there is no load controller 9"),
    "dof": (boundary(">z<", ">q<"), "<dof> must be one of x, y, z, not 'q'"),
    "value": (boundary(">0.1<", ">nan<"), "<value> must be a finite number"),
    "flag": (boundary("</bc>", "<relative>perhaps</relative></bc>"), "<relative> must be 0 or 1, not 'perhaps'"),
    "initial dof": (
        section('<Initial><ic type="init_dof" node_set="top"><dof>q</dof><value>1</value></ic></Initial>'),
        "<dof> must be one of",
    ),
    "pressure of a solid": (
        section('<Initial><ic type="init_dof" node_set="top"><dof>p</dof><value>1</value></ic></Initial>'),
        'a "solid" model has no fluid pressure',
    ),
    "constraint method": (section(PENALTY.format("LAG", 'id="1" bc="x"')), "<laugon> must be one of penalty"),
    "constraint without id": (section(PENALTY.format("AUGLAG", 'bc="x"')), 'lacks the attribute id="..."'),
    "constraint node": (section(PENALTY.format("AUGLAG", 'id="1000" bc="x"')), "there is no node 1000"),
    "tied node": (cube.text(DAMPED).replace("</Boundary>", TIE.format("five", "x")), "<node> must be an id"),
    "tied dof": (cube.text(DAMPED).replace("</Boundary>", TIE.format("5", "q")), "cannot act on 'q'"),
    "spring without points": (
        section(DISCRETE.format('<force type="point"><interpolate>linear</interpolate><points/></force>')).replace(
            "</Mesh>", '<DiscreteSet name="d"><delem>1,5</delem></DiscreteSet></Mesh>'),
        '<force type="point"> has no points',
    ),
    "spring's curve": (
        section(DISCRETE.format('<force type="point"><interpolate>curly</interpolate><points><pt>0,0</pt><pt>1,1</pt>'
                                "</points></force>")).replace(
            "</Mesh>", '<DiscreteSet name="d"><delem>1,5</delem></DiscreteSet></Mesh>'),
        'interpolation "curly" is unknown',
    ),
    "empty option": (material(SCHEME.format("")), "<nth> must be a number, not ''"),
    "word for a number": (material(SCHEME.format("true")), "<nth> must be a number, not 'true'"),
    "huge option": (material(SCHEME.format("2147483647")), "<nth> must be at most 100000"),
    "spring of no length": (
        section(DISCRETE.format('<measure>strain</measure><force type="math">x</force>')).replace(
            "</Mesh>", '<DiscreteSet name="d"><delem>1,1</delem></DiscreteSet></Mesh>'),
        'nodes 1 and 1 of "d" are in one place: no strain',
    ),
    "set": (boundary('"top"', '"topp"'), 'there is no node set "topp"; did you mean "top"'),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_a_bad_value_is_refused_at_its_line(tmp_path: Path, name: str) -> None:
    content, message = BAD[name]
    with pytest.raises(InputError, match=message) as e:
        lower(cube.read(tmp_path, content))
    assert e.value.where is not None
    line = e.value.where.line
    assert line > 1, "an error must name a line"
    assert str(e.value).startswith(f"{tmp_path / 'cube.feb'}:{line}: ")


@pytest.mark.parametrize("verb", ["validate", "run"])
@pytest.mark.parametrize("name", ["E nan", "fiber 99", "lc text", "set", "no end"])
def test_the_command_says_it_in_one_line(tmp_path: Path, verb: str, name: str) -> None:
    content, message = BAD[name]
    (tmp_path / "cube.feb").write_text(content)
    done = forked.febkit(verb, "cube.feb", folder=tmp_path)
    said = done.stdout + done.stderr
    assert done.returncode == 2
    assert "Traceback" not in said
    assert re.search(message, said)
    assert re.search(r"cube\.feb:\d+: ", said)
    assert not list(tmp_path.glob("*.xplt"))


MAP = """<MeshData><ElementData name="stiff" elem_set="cube"><e lid="{}">{}</e></ElementData></MeshData>"""


@pytest.mark.parametrize("lid", [0, 2, -1])
def test_map_rows_lie_in_the_set(tmp_path: Path, lid: int) -> None:
    """lid 0 would be the last element, counted from the end."""
    text = cube.text(SOLID.format(E="", more="").replace("<E>", '<E type="map">stiff'))
    text = text.replace("</MeshDomains>", "</MeshDomains>" + MAP.format(lid, 5))
    with pytest.raises(InputError, match=rf'map "stiff": row lid={lid} lies outside "cube", which has 1'):
        lower(cube.read(tmp_path, text))


def test_maps_of_one_name_are_one_map(tmp_path: Path) -> None:
    """Fibres of two parts may stand in two <ElementData>; the second was passed over."""
    text = cube.text(FIBER.format('<fiber type="user"/>'))
    rows = '<MeshData>{}</MeshData>'.format("".join(
        f'<ElementData type="fiber" elem_set="{s}"><e lid="1">{v}</e></ElementData>'
        for s, v in (("other", "0,1,0"), ("cube", "0,0,1"))))
    text = text.replace("</MeshDomains>", '<SolidDomain name="other" mat="m"/></MeshDomains>' + rows)
    other = '<Elements type="hex8" name="other"><elem id="2">1,2,3,4,5,6,7,8</elem></Elements>'
    text = text.replace("</Elements>", "</Elements>" + other)
    first, second = lower(read_text(tmp_path, text)).blocks
    assert first.solid.fiber.a.tolist() == [[0, 0, 1]]
    assert second.solid.fiber.a.tolist() == [[0, 1, 0]]


def test_a_map_must_say_something_of_each_element(tmp_path: Path) -> None:
    text = cube.text(SOLID.format(E="", more="").replace("<E>", '<E type="map">stiff'))
    text = text.replace('<Elements type="hex8" name="cube"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>',
                        '<Elements type="hex8" name="cube"><elem id="1">1,2,3,4,5,6,7,8</elem>'
                        '<elem id="2">1,2,3,4,5,6,7,8</elem></Elements>')
    text = text.replace("</MeshDomains>", "</MeshDomains>" + MAP.format(1, 5))
    with pytest.raises(InputError, match='the map "stiff" says nothing of element 2 of "cube"'):
        lower(read_text(tmp_path, text))


def test_an_initial_displacement_is_a_vector(tmp_path: Path) -> None:
    """FEBio's <ic type="displacement"> holds three numbers; init_dof holds one."""
    initial = '<Initial><ic type="displacement" node_set="top"><value>0,0.1,0.2</value></ic></Initial>'
    given = lower(cube.read(tmp_path, section(initial))).common.initial
    assert [(q.column, q.value.number, q.velocity) for q in given] == [(0, 0, False), (1, 0.1, False), (2, 0.2, False)]


def read_text(folder: Path, content: str) -> Model:
    (folder / "cube.feb").write_text(content)
    return read(folder / "cube.feb")


def test_springs_of_an_empty_set_pull_at_nothing(tmp_path: Path) -> None:
    """Their curve was asked for no forces and raised."""
    points = "<interpolate>linear</interpolate><points><pt>0,0</pt><pt>1,1</pt></points>"
    text = section(DISCRETE.format(f'<force type="point">{points}</force>'))
    problem = lower(cube.read(tmp_path, text.replace("</Mesh>", '<DiscreteSet name="d"></DiscreteSet></Mesh>')))
    springs = problem.common.loads[0]
    assert springs.force(np.zeros(0)).shape == (0,)
    assert springs.force(np.array([0.5])).tolist() == [0.5]
