"""Models made in memory are written and read back the same, in every version."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from febkit.feb import diff, read_bytes, to_bytes, write
from febkit.feb.convert import VERSIONS
from febkit.model import (
    Component,
    Domain,
    ElementBlock,
    ElementSet,
    LoadController,
    LogEntry,
    Mesh,
    MeshData,
    Model,
    NodeSet,
    Output,
    PlotVariable,
    Step,
    Surface,
)

C = Component


def cube(X):
    block = ElementBlock("block", "hex8", np.array([1]), np.arange(8)[None])
    return Mesh(np.arange(1, 9), X, (block,), {"bottom": NodeSet("bottom", np.arange(4))},
                {"top": Surface("top", {"quad4": np.array([[4, 5, 6, 7]])})})


X0 = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)


def model(X=X0, E="1.5", points=((0.0, 0.0), (1.0, 1.0)), steps=None):
    solid = C("material", "neo-Hookean", "m", 1, children=(C("E", text=E), C("v", text="0.3")))
    bc = C("bc", "zero displacement", "fix", attrs={"node_set": "bottom"},
           children=tuple(C(f"{d}_dof", text="1") for d in "xyz"))
    load = C("surface_load", "pressure", "p", attrs={"surface": "top"},
             children=(C("pressure", text="0.25", attrs={"lc": "1"}),))
    control = C("Control", children=(C("analysis", text="STATIC"), C("time_steps", text="2"),
                                     C("step_size", text="0.5")))
    return Model("4.0", "solid", cube(X), (solid,), (Domain("block", "solid", "m"),),
                 common=Step(boundary=(bc,), loads=(load,)), steps=steps or (Step(control=control),),
                 controllers=(LoadController(1, "loadcurve", C("load_controller", "loadcurve", id=1), points=points),),
                 output=Output((PlotVariable("displacement"), PlotVariable("stress", "s")),
                               log=(LogEntry("node_data", "x;y", set="bottom"),)))


def test_every_version(tmp_path):
    m = model()
    for version in VERSIONS:
        notes = write(m, tmp_path / "m.feb", version)
        again = read_bytes((tmp_path / "m.feb").read_bytes())
        found = [d for d in diff(m, again) if not d.what.startswith(("node set", "surface", "part", "domain"))]
        assert again.version == version and found == []
        assert notes == [] or version == "1.2"


def test_the_default_version_is_4(tmp_path):
    write(model(), tmp_path / "m.feb")
    again = read_bytes((tmp_path / "m.feb").read_bytes())
    assert again.version == "4.0" and diff(model(), again) == []


def test_maps_sets_and_names_that_need_escapes():
    from dataclasses import replace

    m = model()
    maps = (MeshData("element", "axes", "block", C("ElementData", attrs={"data_type": "vec3"}),
                     np.array([1]), np.array([[1.0, 1e-300, -2.5e10]])),
            MeshData("element", "mat_axis", "block", C("ElementData", "mat_axis"), np.array([1]),
                     np.array([[1.0, 0, 0, 0, 1, 0]])))
    odd = 'a<b> & "c"'
    mesh = replace(m.mesh, element_sets={odd: ElementSet(odd, np.array([1]))})
    m = replace(m, mesh=mesh, mesh_data=maps, variables={"k": 0.1}, constants={"T": 298.0}, units="mm-N-s")
    again = read_bytes(to_bytes(m)[0])
    assert diff(m, again) == [] and odd in again.mesh.element_sets
    np.testing.assert_array_equal(again.mesh_data[0].values, maps[0].values)


def test_multi_step_models():
    control = C("Control", children=(C("time_steps", text="3"), C("step_size", text="0.1")))
    steps = (Step("one", control), Step("two", control, loads=(C("body_load", "body force", children=(
        C("force", text="0,0,1"),)),)))
    m = model(steps=steps)
    again = read_bytes(to_bytes(m)[0])
    assert [s.name for s in again.steps] == ["one", "two"] and diff(m, again) == []


NUMBERS = st.floats(-1e12, 1e12).filter(lambda v: v == 0 or abs(v) > 1e-200)


@settings(max_examples=60, deadline=None)
@given(st.lists(NUMBERS, min_size=24, max_size=24), NUMBERS,
       st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=5), st.sampled_from(VERSIONS))
def test_numbers_survive_exactly(x, e, points, version):
    X = np.array(x).reshape(8, 3)
    m = model(X, repr(e), tuple(points))
    again = read_bytes(to_bytes(m, version)[0])
    np.testing.assert_array_equal(again.mesh.X, X)
    assert again.controllers[0].points == tuple(points)
    assert again.materials[0].float("E") == e


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(["a", "b", "value"]), st.text(
    st.characters(min_codepoint=32, max_codepoint=0x2FFF, exclude_categories=("Cs", "Cc", "Co", "Cn")), max_size=12)),
    max_size=5), st.sampled_from(["4.0", "3.0"]))
def test_any_text_survives(children, version):
    from dataclasses import replace

    m = model()
    tree = C("material", "odd & <new>", "m", 1, children=tuple(C(t, text=s.strip()) for t, s in children))
    again = read_bytes(to_bytes(replace(m, materials=(tree,)), version)[0])
    assert [(c.tag, c.text) for c in again.materials[0]] == [(t, s.strip()) for t, s in children]
    assert again.materials[0].type == "odd & <new>"
