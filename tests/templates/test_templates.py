"""Templates: parameters, expressions, cases of the study, folders of one's own."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from febkit.feb import read, write
from febkit.model import InputError, Model, Where
from febkit.templates import new
from febkit.templates.expression import evaluate, fill, must_points
from febkit.templates.parameters import from_text
from febkit.templates.skeleton import expand
from febkit.templates.template import BUILT_IN, load

STUDY = ("tissue", "cell", "embedded")

TIMES = [0, 0.01, 0.05, 0.1, 0.15, 0.2, 0.5, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 15, 20, 25, 30, 35, 40, 45, 50,
         60, 70, 80, 90, 100]
SHARED = Path(__file__).parents[2].parent / "shared"


def small(name: str, **given: Any) -> Model:
    return new(name, size="small", **given)


def boundary(model: Model) -> dict[str, Any]:
    return {c.name: c for c in model.common.boundary}


@pytest.mark.parametrize("name", ["tissue", "embedded"])
@pytest.mark.parametrize("case", "ABCD")
def test_boundary_conditions_of_each_case(name: str, case: str) -> None:
    model = small(name, case=case)
    bc = boundary(model)
    assert ("drained bottom" in bc) == (case in "AC")
    assert bc["drained top"].attrs["node_set"] == "top"
    top = bc["top"].need("value")
    assert top.lc == 1
    if case in "AB":
        assert top.as_float() == -0.1
        return
    x = np.array([[-0.5, -0.5], [0.5, 0.5], [0.0, 0.5], [-0.25, 0.1]])
    names = {"sqrt": np.sqrt, "abs": np.abs}
    u = [eval(top.text, {"__builtins__": {}}, names | {"X": a, "Y": b}) for a, b in x]
    assert np.allclose(u, -0.05 * np.sqrt(x[:, 0] + 0.5) - 0.05 * np.sqrt(x[:, 1] + 0.5))


@pytest.mark.parametrize("name", STUDY)
def test_sampling_times_are_must_points(name: str) -> None:
    model = small(name)
    ramp, must = model.controllers
    assert ramp.points == ((0, 0), (0.1, 1), (100, 1))
    assert [t for t, _ in must.points] == TIMES
    control = model.steps[0].control
    assert control is not None
    assert control.str("plot_level") == "PLOT_MUST_POINTS"
    stepper = control.need("time_stepper")
    assert stepper.need("dtmax").lc == must.id
    assert control.int("time_steps") * control.float("step_size") == pytest.approx(100.0)


def test_materials_of_the_study() -> None:
    model = small("embedded")
    table = {m.name: m for m in model.materials}
    for name, E, v, k in (("ecm", 1.0, 0.125, 0.002), ("pcm", 0.043, 0.125, 0.002),
                          ("chondrocyte", 0.001, 0.4, 0.001)):
        solid = table[name].need("solid")
        assert (solid.type, solid.float("E"), solid.float("v")) == ("neo-Hookean", E, v)
        assert table[name].need("permeability").float("perm") == k
    assert {d.block: d.material for d in model.domains}["tissue"] == "ecm"
    assert model.units == "mm-N-s"


@pytest.mark.parametrize("name", STUDY)
def test_model_survives_writing_and_reading(name: str, tmp_path: Path) -> None:
    model = small(name, case="D")
    write(model, tmp_path / "m.feb")
    back = read(tmp_path / "m.feb")
    assert np.array_equal(back.mesh.X, model.mesh.X)
    for a, b in zip(back.mesh.blocks, model.mesh.blocks, strict=True):
        assert (a.name, a.type) == (b.name, b.type)
        assert np.array_equal(a.conn, b.conn) and np.array_equal(a.ids, b.ids)
    for key, s in model.mesh.surfaces.items():
        for kind, conn in s.facets.items():
            assert np.array_equal(back.mesh.surfaces[key].facets[kind], conn)
    for key, nodes in model.mesh.node_sets.items():
        assert np.array_equal(back.mesh.node_sets[key].nodes, nodes.nodes)
    assert back.mesh.part_lists == model.mesh.part_lists
    assert ([(c.type, c.attrs) for c in back.common.boundary]
            == [(c.type, c.attrs) for c in model.common.boundary])
    assert back.controllers[1].points == model.controllers[1].points
    assert {d.block for d in back.domains} == {b.name for b in back.mesh.blocks}


def test_named_surfaces_are_where_they_say() -> None:
    mesh = small("embedded").mesh
    X = mesh.X
    for name, axis, value in (("left", 0, -0.5), ("right", 0, 0.5), ("front", 1, -0.5), ("back", 1, 0.5),
                              ("bottom", 2, -0.5), ("top", 2, 0.5)):
        assert np.allclose(X[mesh.surfaces[name].facets["quad4"], axis], value)
    q = X[mesh.surfaces["cell_cube"].facets["quad4"]]
    assert np.allclose(np.abs(q).max(axis=2), 0.05)
    assert len(q) == 6 * 12 * 12
    for i in (1, 11):
        q = X[mesh.surfaces[f"cell_{i}_surface"].facets["quad4"]]
        centre = q.reshape(-1, 3).mean(axis=0)
        normal = np.cross(q[:, 1] - q[:, 0], q[:, 2] - q[:, 1])
        assert (np.einsum("fi,fi->f", normal, q.mean(axis=1) - centre) > 0).all()  # out of the cell
        assert len(q) == len(mesh.surfaces[f"pcm_{i}_surface"].facets["quad4"]) == 54
    top = mesh.node_sets["top"].nodes
    assert np.allclose(X[top, 2], 0.5) and len(top) == np.isclose(X[:, 2], 0.5).sum()
    sides = mesh.node_sets["x_faces"].nodes
    assert len(sides) == np.isclose(np.abs(X[:, 0]), 0.5).sum()


@pytest.mark.skipif(not (SHARED / "oracle").is_dir(), reason="reference models are not here")
@pytest.mark.parametrize("case", "ABCD")
def test_tissue_is_the_reference_model(case: str) -> None:
    """Same nodes, elements, sets and displacements as the inputs that FEBio solved."""
    theirs = read(SHARED / "oracle" / "study" / "models" / f"tissue11_{case}.feb")
    ours = new("tissue", n=11, case=case)
    assert np.allclose(ours.mesh.X, theirs.mesh.X, atol=1e-9)
    assert np.array_equal(ours.mesh.blocks[0].conn, theirs.mesh.blocks[0].conn)
    for a, b in (("x_faces", "x"), ("y_faces", "y"), ("bottom", "bottom"), ("top", "top")):
        assert np.array_equal(ours.mesh.node_sets[a].nodes, np.sort(theirs.mesh.node_sets[b].nodes))
    assert [c.type for c in ours.common.boundary] == [c.type for c in theirs.common.boundary]


@pytest.mark.skipif(not (SHARED / "oracle").is_dir(), reason="reference models are not here")
def test_time_control_is_the_reference_models() -> None:
    theirs = read(SHARED / "oracle" / "bench" / "models" / "cell_small.feb")
    ours = small("cell")
    for a, b in zip(ours.controllers, theirs.controllers, strict=True):
        assert np.allclose(a.points, b.points)
    mine, other = ours.steps[0].control, theirs.steps[0].control
    assert mine is not None and other is not None
    for tag in ("analysis", "plot_level"):
        assert mine.str(tag) == other.str(tag)
    for tag in ("time_steps", "step_size"):
        assert mine.float(tag) == other.float(tag)
    for tag in ("max_retries", "opt_iter", "dtmin", "aggressiveness"):
        assert mine.need("time_stepper").float(tag) == other.need("time_stepper").float(tag)


def test_nominal_drive_of_the_cell_cube() -> None:
    bc = boundary(small("cell", case="C"))
    text = bc["nominal z"].need("value").text
    u = [eval(text, {"__builtins__": {}}, {"X": a, "Y": b, "Z": c}) for a, b, c in np.eye(3)]
    # d/dX of (Z + 1/2) u_top(X, Y) at the middle of the tissue
    h = 1e-6

    def field(x: float, y: float, z: float) -> float:
        return -(z + 0.5) * 0.05 * (np.sqrt(x + 0.5) + np.sqrt(y + 0.5))

    expected = [(field(*(h * e)) - field(*(-h * e))) / (2 * h) for e in np.eye(3)]
    assert np.allclose(u, expected, rtol=1e-6)
    assert not small("cell", drive="none").common.boundary


# parameters

@pytest.mark.parametrize("name", BUILT_IN)
def test_every_parameter_is_documented_and_its_default_allowed(name: str) -> None:
    template = load(name)
    for p in template.parameters.values():
        assert len(p.doc) > 10
        p.checked(p.default)
    known = {"edge", "depth", "centre", "diameter", "thickness", "tissue_edge", "radius", "width"}
    lengths = known & set(template.parameters)
    assert all(template.parameters[n].unit == "mm" for n in lengths)
    for table in template.sizes.values():
        assert set(table) <= set(template.parameters)


@pytest.mark.parametrize(("given", "words"), [
    ({"nn": 3}, "no parameter"), ({"case": "E"}, "one of A, B, C, D"), ({"n": 2.5}, "integer"),
    ({"n": 0}, "at least 1"), ({"ecm_v": 0.5}, "less than 0.5"), ({"ecm_E": "stiff"}, "number"),
    ({"times": [0, 2, 1]}, "rising"), ({"times": [0]}, "rising"), ({"size": "huge"}, "size must be one of"),
    ({"depth": True}, "number"),
])
def test_bad_values_are_refused(given: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        new("tissue", **given)


def test_lists_have_their_length() -> None:
    with pytest.raises(InputError, match="3 entries"):
        new("cell", layers=[1, 2])


def test_later_values_win_over_size_and_file() -> None:
    template = load("tissue")
    values = template.values([({"n": 7, "depth": 0.05}, Where("f.toml")), ({"size": "small"}, Where()),
                              ({"depth": 0.02}, Where())])
    assert (values["n"], values["depth"]) == (7, 0.02)
    assert template.values([({"size": "small"}, Where())])["n"] == 11
    assert template.values()["n"] == 35


@pytest.mark.parametrize(("text", "value"), [
    ("11", 11), ("0.5", 0.5), ("A", "A"), ("true", True), ("3,2,2", [3, 2, 2]),
    ("[[0,0,0.01]]", [[0, 0, 0.01]]),
    ('{1="ecm"}', {"1": "ecm"}), ("my mesh.vtk", "my mesh.vtk"), ("1e-3", 1e-3),
])
def test_values_from_the_command_line(text: str, value: Any) -> None:
    assert from_text(text) == value


# expressions

@pytest.mark.parametrize(("text", "value"), [
    ("1 + 2*3 - 4/8", 6.5), ("-n**2", -9), ("n % 2 == 1 and not n > 4", True), ("'A' if n < 3 else 'B'", "B"),
    ("times[-1]", 2.0), ("case in ('A', 'C')", True), ("case not in ['A']", False), ("sqrt(16)", 4.0),
    ("max(n, 7)", 7), ("[i_, n]", [1, 3]),
])
def test_expressions(text: str, value: Any) -> None:
    assert evaluate(text, {"n": 3, "times": [0.0, 2.0], "case": "A", "i_": 1}) == value


@pytest.mark.parametrize("text", [
    "__import__('os')", "n.real", "(lambda: 1)()", "unknown", "1 +", "[x for x in times]", "open('f')", "1/0",
])
def test_expressions_that_are_refused(text: str) -> None:
    with pytest.raises(InputError):
        evaluate(text, {"n": 3, "times": [1]})


def test_fill_writes_numbers_as_feb_does() -> None:
    names = {"a": 0.1 + 0.2, "b": True, "c": [1, 2.5], "d": 3}
    assert fill("${a};${b};${c};${d*2}", names) == "0.3;1;1,2.5;6"


def test_must_points_keep_to_the_longest_step() -> None:
    assert must_points([0, 1, 3, 10], 5.0) == [(0, 1), (1, 1), (3, 2), (10, 5.0)]
    assert must_points([0, 1, 3, 10], 5.0, 0.5, 1.0) == [(0, 0.5), (1, 0.5), (3, 2), (10, 5.0)]


# folders of one's own

SKELETON = """<?xml version="1.0"?>
<febio_spec version="4.0">
	<Module type="solid"/>
	<Material>
		<material id="1" name="m" type="neo-Hookean"><E>${E}</E><v>0.3</v></material>
	</Material>
	<MeshDomains>
		<SolidDomain for="name, role in parts" name="${name}" mat="m"/>
	</MeshDomains>
	<Boundary>
		<bc if="fixed" for="s in sides" name="${s}" type="zero displacement" node_set="${s}">
			<x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof>
		</bc>
	</Boundary>
</febio_spec>
"""
PARAMETERS = """title = "Mine"
mesh = "tissue"
[parameters]
E = {default = 2.0, unit = "MPa", above = 0, doc = "Young's modulus of the block"}
n = {default = 3, min = 1, doc = "elements along an edge"}
edge = {default = 1.0, unit = "mm", doc = "edge of the block"}
centre = {default = 0.0, unit = "mm", doc = "edge of the middle element"}
grading = {default = 1.0, doc = "grading of the elements"}
element = {default = "tet4", doc = "element type"}
part = {default = "tissue", doc = "name of the part"}
vertical = {default = 0, doc = "elements in height"}
fixed = {default = true, doc = "hold the sides"}
sides = {default = ["top", "bottom"], doc = "sides that are held"}
"""


def test_a_template_of_ones_own(tmp_path: Path) -> None:
    (tmp_path / "template.toml").write_text(PARAMETERS)
    (tmp_path / "model.feb").write_text(SKELETON)
    model = new("mine", tmp_path, E=5.0)
    assert model.module == "solid"
    assert model.materials[0].float("E") == 5.0
    assert [c.attrs["node_set"] for c in model.common.boundary] == ["top", "bottom"]
    assert model.mesh.blocks[0].type == "tet4"
    assert not new("mine", tmp_path, fixed=False).common.boundary


def test_a_folder_that_builds_on_another(tmp_path: Path) -> None:
    folder = tmp_path / "big"
    folder.mkdir()
    (folder / "template.toml").write_text('base = "cell"\n[parameters]\ndiameter = 0.012\necm_E = 2.0\n'
                                          "[sizes.tiny]\nn = 9\ncells = 1\nlayers = [1, 1, 1]\n")
    model = new("big", tmp_path, size="tiny")
    assert model.materials[0].need("solid").float("E") == 2.0
    assert len([b for b in model.mesh.blocks if b.name.startswith("cell_")]) == 1
    template = load("big", tmp_path)
    assert template.parameters["ecm_E"].unit == "MPa"
    with pytest.raises(InputError, match="greater than 0"):
        template.values([({"ecm_E": -1.0}, Where())])


@pytest.mark.parametrize(("toml", "words"), [
    ("title = ", "TOML"), ('mesh = "sphere"', "no mesh generator"), ("colour = 1", "unknown entry"),
    ('base = "nothing"', "neither"),
    ('base = "cell"\n[parameters.x]\ndefault = 1', "needs a default and a doc"),
    ('base = "cell"\n[parameters.x]\ndefault = 1\ndoc = "some doc"\ncolor = 2', "no field"),
    ('base = "../big"', "circle"),
])
def test_faulty_templates_are_refused(tmp_path: Path, toml: str, words: str) -> None:
    folder = tmp_path / "big"
    folder.mkdir()
    (folder / "template.toml").write_text(toml)
    with pytest.raises(InputError, match=words):
        load("big", folder)


@pytest.mark.parametrize(("xml", "words"), [
    ("<febio_spec>", "well-formed"), ("<a>${nothing}</a>", "no parameter"),
    ('<a><b for="x"/></a>', "name in list"),
])
def test_faulty_skeletons_are_refused(tmp_path: Path, xml: str, words: str) -> None:
    path = tmp_path / "model.feb"
    path.write_text(xml)
    with pytest.raises(InputError, match=words):
        expand(path, {})


def test_unknown_template() -> None:
    with pytest.raises(InputError, match="tissue, cell, embedded, cartilage, chondron"):
        load("bone")


@pytest.mark.parametrize(("text", "why"), [
    ("9**9**9**9", "whole number of more than"), ("range(10**12)", "range of more than"),
    ("[0]*10**9", "list or text of more than"), ("'a'*10**10", "list or text of more than"),
    ("(-8)**0.5", "no finite number"), ("1e308*10", "no finite number"), ("-" * 5000 + "1", "cannot be evaluated"),
    ("(" * 5000 + "1" + ")" * 5000, "cannot be evaluated"), ("10**400 + 0.5", "cannot be evaluated"),
])  # fmt: skip
def test_expressions_are_bounded(text: str, why: str) -> None:
    """A template is a file that somebody else may have written: it takes no hours and no memory."""
    start = time.perf_counter()
    with pytest.raises(InputError, match=why) as e:
        evaluate(text, {}, Where("template.feb", 3))
    assert str(e.value).startswith("template.feb:3: ")
    assert len(str(e.value)) < 500
    assert time.perf_counter() - start < 2.0
