"""Boundary sections: every form carries the same histories; conditions, must points and sets of the cell model."""

import re

import numpy as np
import pytest

from febkit.coupling import drive, handoff, overlay, series, surface_nodes, write, write_section
from febkit.coupling.formula import LONGEST, history
from febkit.feb import read
from febkit.model import (
    Component,
    Domain,
    ElementBlock,
    InputError,
    Mesh,
    Model,
    NodeSet,
    Step,
)
from febkit.model import math as formulas

from .conftest import Polynomial, field, mesh

TIMES = np.array([0.0, 0.1, 0.25, 1.0, 3.0, 100.0])


def leaf(tag, text, **attrs):
    return Component(tag, text=str(text), attrs=attrs)


def cell(module="biphasic", boundary=(), stepper=True, sets=None):
    """A small cube as a cell model."""
    X, conn = mesh("hex8", 2)
    X = 0.1 * X
    solid = Component("solid", "neo-Hookean", children=(leaf("density", 1), leaf("E", 1), leaf("v", 0.1)))
    flow = Component("permeability", "perm-const-iso", children=(leaf("perm", 0.01),))
    material = Component("material", "biphasic", "ecm", 1, children=(leaf("phi0", 0.2), solid, flow))
    control = [leaf("analysis", "TRANSIENT"), leaf("time_steps", 10), leaf("step_size", 0.05)]
    if stepper:
        control.append(Component("time_stepper", "default", children=(leaf("dtmin", 0.001), leaf("dtmax", 2))))
    m = Mesh(np.arange(1, len(X) + 1) * 2, X, (ElementBlock("ecm", "hex8", np.arange(len(conn)) + 1, conn),),
             node_sets={n: NodeSet(n, np.asarray(i)) for n, i in (sets or {}).items()})
    return Model("4.0", module, m, (material,), (Domain("ecm", "solid", "ecm"),),
                 common=Step(boundary=tuple(boundary)),
                 steps=(Step(control=Component("Control", children=tuple(control))),))


@pytest.fixture(scope="module")
def driving():
    rng = np.random.default_rng(0)
    f = field("hex27", 3, Polynomial(3, 1), lambda x: Polynomial(3, 2, 1)(x)[:, 0])
    wave = np.concatenate([[0.0], rng.uniform(-1, 1, len(TIMES) - 1)])
    from febkit.coupling.field import Field

    f = Field(f.X, f.blocks, TIMES, wave[:, None, None] * f.u[1], np.cos(TIMES)[:, None] * f.p[1])
    return f, series(f, [0.1, 0.05, -0.1], order=3, recovery="polynomial")


def values_of(model, t):
    """What the four conditions of a driven model say at its nodes, by febkit's own formulas and curves."""
    curves = {c.id: np.array(c.points) for c in model.controllers}
    helpers = {m.name: m.need("E") for m in model.materials if m.name.startswith("drive_")}

    def evaluate(text, X):
        names = re.findall(r"\$\{(fem\.material\('(\w+)'\)\.E)\}", text)
        f = formulas.compile(text, ("X", "Y", "Z", "t", *(n for n, _ in names)))
        extra = {}
        for name, helper in names:
            e = helpers[helper]
            extra[name] = evaluate(e.text, X) if e.type == "math" else np.interp(t, *curves[e.lc].T)
        return f(*X.T, t=t, **extra) * np.ones(len(X))

    out = {}
    for c in model.common.boundary:
        X = model.mesh.X[model.mesh.node_sets[c.attrs["node_set"]].nodes]
        value = c.need("value")
        assert len(value.text) <= 511
        out[c.str("dof", "p")] = evaluate(value.text, X)
    return out


@pytest.mark.parametrize(("order", "fluid"), [(1, 1), (2, 1), (3, 3)])
@pytest.mark.parametrize("origin", [(0, 0, 0), (0.01, -0.02, 0.0)])
def test_formulas_give_the_histories_at_and_between_the_times(driving, order, fluid, origin):
    model = cell()
    nodes = surface_nodes(model.mesh)
    h = handoff(driving[1], model.mesh.X[nodes], order=order, fluid_order=fluid, origin=origin)
    made = drive(model, h, nodes)
    assert made.form == "parameters"
    for t in (0.0, 0.1, 0.17, 2.0, 100.0, 150.0):
        got = values_of(made.model, t)
        for k, dof in enumerate("xyz"):
            wanted = [np.interp(t, TIMES, h.u[:, n, k]) for n in range(len(nodes))]
            assert np.abs(got[dof] - wanted).max() < 1e-13
        wanted = [np.interp(t, TIMES, h.p[:, n]) for n in range(len(nodes))]
        assert np.abs(got["p"] - wanted).max() < 1e-13


def test_a_few_times_are_spelled_out_in_the_expression(driving):
    f, _ = driving
    model = cell()
    nodes = surface_nodes(model.mesh)
    ds = series(f, [0.1, 0.05, -0.1], order=1, times=[0.0, 1.0])
    h = handoff(ds, model.mesh.X[nodes], order=1)
    made = drive(model, h, nodes)
    assert made.form == "math"
    assert len(made.model.materials) == 1 and len(made.model.controllers) == 1  # its must points
    for t in (0.0, 0.3, 1.0, 7.0):
        got = values_of(made.model, t)
        for k, dof in enumerate("xyz"):
            assert np.abs(got[dof] - h.u[1, :, k] * min(t, 1.0)).max() < 1e-14
    with pytest.raises(InputError, match="FEBio crashes beyond 511"):
        drive(model, handoff(driving[1], model.mesh.X[nodes]), nodes, form="math")


def test_a_spelled_out_history_is_constant_outside_its_times():
    values = np.array([0.1, 0.5, -0.2, 0.3, 0.3, 1.0])
    f = formulas.compile(history(TIMES, values).lstrip("+"))
    for t in (-1.0, 0.0, 0.05, 0.1, 0.2, 50.0, 100.0, 1e4):
        assert float(f(t=t)) == pytest.approx(np.interp(t, TIMES, values), abs=1e-15 * max(100, 10 * abs(t)))


@pytest.mark.parametrize("version", ["4.0", "3.0", "2.5"])
def test_curves_hold_one_history_per_node_and_dof(driving, version, tmp_path):
    model = cell()
    nodes = surface_nodes(model.mesh)
    h = handoff(driving[1], model.mesh.X[nodes])
    made = drive(model, h, nodes, form="curves", version=version)
    path = tmp_path / "m.feb"
    write(made, path, version)
    assert f'version="{version}"' in path.read_text()[:200]
    back = read(path)
    curves = {c.id: np.array(c.points) for c in back.controllers}
    assert sorted(curves) == list(range(1, len(curves) + 1))  # FEBio wants them numbered on
    assert len(back.common.boundary) == 4 * len(nodes)
    place = {n: k for k, n in enumerate(nodes.tolist())}
    for c in back.common.boundary:
        at = place[int(back.mesh.node_sets[c.attrs["node_set"]].nodes[0])]
        dof = "xyzp".index(c.str("dof", "p"))
        wanted = h.p[:, at] if dof == 3 else h.u[:, at, dof]
        points = curves[c.need("value").lc]
        assert np.array_equal(points[:, 0], TIMES) and np.array_equal(points[:, 1], wanted)


def test_older_versions_and_overlays_take_curves(driving):
    f, ds = driving
    model = cell()
    nodes = surface_nodes(model.mesh)
    h = handoff(ds, model.mesh.X[nodes])
    assert drive(model, h, nodes, version="2.5").form == "curves"
    assert drive(model, overlay(f, model.mesh.X[nodes], [0.1, 0, 0]), nodes).form == "curves"
    with pytest.raises(InputError, match="needs a load curve per node"):
        drive(model, h, nodes, version="3.0", form="math")
    with pytest.raises(InputError, match="forms are"):
        drive(model, h, nodes, form="smoke")


@pytest.mark.parametrize("form", ["parameters", "curves"])
def test_a_section_holds_the_hand_off_alone(driving, form, tmp_path):
    model = cell()
    nodes = surface_nodes(model.mesh)
    made = drive(model, handoff(driving[1], model.mesh.X[nodes]), nodes, form=form)
    write_section(made, tmp_path / "s.feb")
    from lxml import etree

    root = etree.parse(tmp_path / "s.feb").getroot()
    assert root.get("version") == "4.0"
    assert len(root.findall("Boundary/bc")) == (4 if form == "parameters" else 4 * len(nodes))
    ids = [int(c.get("id")) for c in root.findall("LoadData/load_controller")]
    first = max(c.id for c in made.model.controllers if not (c.name or "").startswith("drive_")) + 1
    assert ids == list(range(first, first + len(ids)))
    if form == "parameters":
        assert root.find("Material/material").get("id") == "2"
        assert max(len(v.text) for v in root.findall("Boundary/bc/value")) <= LONGEST


def zero(nodes, **dofs):
    return Component("bc", "zero displacement", attrs={"node_set": nodes},
                     children=tuple(leaf(f"{d}_dof", 1) for d in "xyz"))


def test_conditions_on_the_driven_nodes_are_replaced(driving):
    X = cell().mesh.X
    skin = np.nonzero(np.abs(X).max(axis=1) > 0.0499)[0]
    model = cell(boundary=[zero("skin"), Component("bc", "zero fluid pressure", attrs={"node_set": "skin"})],
                 sets={"skin": skin})
    made = drive(model, handoff(driving[1], X[skin]), skin)
    assert made.node_set == "skin"
    assert len(made.model.common.boundary) == 4
    assert sum("replaced" in s for s in made.said) == 2


def test_conditions_that_reach_further_are_an_error(driving):
    X = cell().mesh.X
    model = cell(boundary=[zero("all")], sets={"all": np.arange(len(X))})
    nodes = surface_nodes(model.mesh)
    with pytest.raises(InputError, match='"all" holds 26 of the driven nodes and 1 others'):
        drive(model, handoff(driving[1], X[nodes]), nodes)
    with pytest.raises(InputError, match="already"):
        twice = drive(cell(), handoff(driving[1], X[nodes]), nodes).model
        step = Step(boundary=())
        from dataclasses import replace

        drive(replace(twice, common=step), handoff(driving[1], X[nodes]), nodes)


def test_a_solid_model_gets_no_pressure(driving):
    model = cell("solid")
    nodes = surface_nodes(model.mesh)
    made = drive(model, handoff(driving[1], model.mesh.X[nodes]), nodes)
    assert [c.type for c in made.model.common.boundary] == ["prescribed displacement"] * 3


def dtmax(model):
    return model.steps[0].control.need("time_stepper").need("dtmax")


def test_must_points_meet_the_times_and_keep_the_longest_step(driving):
    model = cell()
    nodes = surface_nodes(model.mesh)
    h = handoff(driving[1], model.mesh.X[nodes])
    made = drive(model, h, nodes).model
    curve = next(c for c in made.controllers if c.id == dtmax(made).lc)
    assert curve.spec.str("interpolate") == "STEP"
    assert np.array(curve.points).tolist() == [[t, 2.0] for t in TIMES]
    again = drive(model, h, nodes, must_points=False).model
    assert dtmax(again).lc is None


def test_must_points_join_those_already_there(driving):
    from dataclasses import replace

    from febkit.coupling.boundary import load_curve

    model = cell()
    old = load_curve(1, "must", np.array([0.0, 0.5, 1.0, 100.0]), np.array([0.01, 0.1, 0.2, 5.0]), "STEP")
    step = model.steps[0]
    stepper = Component("time_stepper", "default", children=(leaf("dtmax", 1, lc="1"),))
    control = replace(step.control, children=(*step.control.children[:-1], stepper))
    model = replace(model, controllers=(old,), steps=(replace(step, control=control),))
    nodes = surface_nodes(model.mesh)
    made = drive(model, handoff(driving[1], model.mesh.X[nodes]), nodes).model
    assert list(made.controllers[0].points) == [
        (0.0, 0.01), (0.1, 0.1), (0.25, 0.1), (0.5, 0.1), (1.0, 0.2), (3.0, 5.0), (100.0, 5.0)]
    assert made.controllers[0].spec.need("points").children[1].text == "0.1,0.1"


def test_fixed_steps_are_told_apart(driving):
    model = cell(stepper=False)
    nodes = surface_nodes(model.mesh)
    made = drive(model, handoff(driving[1], model.mesh.X[nodes]), nodes)
    assert any("fixed size" in s for s in made.said)


def test_a_driven_file_reads_back_the_same(driving, tmp_path):
    model = cell()
    nodes = surface_nodes(model.mesh)
    h = handoff(driving[1], model.mesh.X[nodes])
    made = drive(model, h, nodes)
    write(made, tmp_path / "m.feb")
    back = read(tmp_path / "m.feb")
    assert np.array_equal(values_of(back, 0.3)["z"], values_of(made.model, 0.3)["z"])
