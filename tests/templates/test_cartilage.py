"""Whole cartilage: its meshes, what varies over depth, loads, and a solution that is known."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit.feb import read, write
from febkit.feb.validation import check, validate
from febkit.lower import lower
from febkit.model import InputError, Model, Where
from febkit.templates import new
from febkit.templates.course import course
from febkit.templates.quality import volumes
from febkit.templates.template import load

EXAMPLE = Path(__file__).parents[2] / "examples" / "biomultiscale_tissue.toml"


def small(**given: Any) -> Model:
    return new("cartilage", size="small", **given)


def conditions(model: Model) -> dict[str, Any]:
    return {c.name: c for c in model.common.boundary}


def rows(model: Model, name: str) -> np.ndarray:
    (data,) = [d for d in model.mesh_data if d.name == name]
    assert data.values is not None
    return np.asarray(data.values)


def tissue_volume(model: Model) -> float:
    return sum(float(volumes(model.mesh.X, "hex8", b.conn).sum()) for b in model.mesh.blocks if b.name != "indenter")


# meshes

@pytest.mark.parametrize(("given", "exact", "part"), [
    ({"shape": "column", "width": [0.2, 0.3], "thickness": 2.0}, 0.12, 1e-12),
    ({"shape": "disc", "core": 8}, math.pi * 1.5**2, 4e-3),
    ({"shape": "disc", "core": 8, "quarter": True}, math.pi * 1.5**2 / 4, 4e-3),
])  # fmt: skip
def test_volumes(given: dict[str, Any], exact: float, part: float) -> None:
    assert tissue_volume(small(**given)) == pytest.approx(exact, rel=part)


@pytest.mark.parametrize("R", [6.0, -6.0])
def test_a_curved_layer_is_as_thick_everywhere(R: float) -> None:
    model = small(shape="curved", curvature=R, thickness=0.8)
    X, sets = model.mesh.X, model.mesh.node_sets
    centre = np.array([0.0, 0.0, 0.8 - R])
    top, bone = (np.linalg.norm(X[sets[s].nodes] - centre, axis=1) for s in ("top", "bottom"))
    assert np.allclose(top, abs(R))
    assert np.allclose(bone, abs(R) - 0.8 if R > 0 else abs(R) + 0.8)
    assert np.allclose(X[sets["x_plane"].nodes, 0], 0.0) and np.allclose(X[sets["y_plane"].nodes, 1], 0.0)
    assert X[sets["top"].nodes, 2].max() == pytest.approx(0.8 if R > 0 else 0.8 + 6 - math.sqrt(36 - 1.5**2))


@pytest.mark.parametrize("shape", ["column", "disc", "curved"])
def test_surfaces_close_the_layer_and_point_outwards(shape: str) -> None:
    """The volume under all surfaces, by the divergence theorem, is that of the elements."""
    model = small(shape=shape, pressed_by="plate")
    X, s = model.mesh.X, model.mesh.surfaces
    closed = [n for n in ("top", "bottom", "sides", "x_plane", "y_plane") if n in s]
    total = 0.0
    for q in (X[s[n].facets["quad4"]] for n in closed):
        a = np.cross(q[:, 1] - q[:, 0], q[:, 2] - q[:, 0]) + np.cross(q[:, 2] - q[:, 0], q[:, 3] - q[:, 0])
        total += float(np.einsum("fi,fi->", a, q.mean(axis=1))) / 6.0
    assert total == pytest.approx(tissue_volume(model), rel=2e-3 if shape == "curved" else 1e-9)


def test_zones_are_parts_and_end_where_they_say() -> None:
    model = small(grading=4.0, thickness=2.0)
    below = 2.0 - model.mesh.X[:, 2]
    ends = {b.name: (below[b.conn].min(), below[b.conn].max()) for b in model.mesh.blocks}
    assert list(ends) == ["superficial", "transitional", "deep"]
    assert np.allclose(list(ends.values()), [(0.0, 0.3), (0.3, 1.4), (1.4, 2.0)])
    z = np.unique(model.mesh.X[:, 2].round(9))
    assert len(z) == 11 and np.diff(z)[0] > 2.5 * np.diff(z)[-1]
    assert model.mesh.part_lists["cartilage"] == tuple(ends)
    assert {d.block: d.material for d in model.domains} == {n: n for n in ends}


def test_every_layer_is_a_part_where_a_property_must_be_one_number() -> None:
    model = small(E=[[0.0, 1.0], [1.0, 2.0]], M=[[0.0, 4.0], [1.0, 6.0]])
    assert model.mesh.part_lists["deep"] == ("deep_1", "deep_2", "deep_3")
    assert len(model.materials) == len(model.mesh.blocks) == 10
    assert not model.mesh_data
    found = [m.need("solid").children[1].float("E") for m in model.materials]
    assert np.allclose(found, [2.0 - model.mesh.X[b.conn, 2].mean() for b in model.mesh.blocks])
    assert [m.need("permeability").float("M") for m in model.materials] == pytest.approx(2 * np.array(found) + 2)


# properties

def test_maps_have_the_value_at_each_elements_depth() -> None:
    model = small(E=[[0.0, 0.2], [0.4, 0.5], [1.0, 1.0]], zones={"all": 1.0}, thickness=2.0)
    X, block = model.mesh.X, model.mesh.blocks[0]
    depth = 1.0 - X[block.conn, 2].mean(axis=1) / 2.0
    assert np.allclose(rows(model, "E_all")[:, 0], np.interp(depth, [0.0, 0.4, 1.0], [0.2, 0.5, 1.0]))
    E = model.materials[0].need("solid").children[1].need("E")
    assert (E.type, E.text) == ("map", "E_all")


@pytest.mark.parametrize("table", [
    [[0.0, 0.2], [1.0, 1.0]], [[0.0, 0.2], [0.3, 0.9], [0.6, 0.4], [1.0, 1.0]], [[0.2, 0.5], [0.7, 0.1]],
    [[0.0, 1.0], [0.5, 1.0], [1.0, 3.0]],
])  # fmt: skip
def test_formulas_are_the_tables_lines(table: list[list[float]]) -> None:
    model = small(E=table, fields="formulas", thickness=2.5, zones={"all": 1.0}, fibres="none", k0=1.0, phi0=0.2)
    E = model.materials[0].need("solid").children[1].need("E")
    assert E.type == "math" and not model.mesh_data
    z = np.linspace(0.0, 2.5, 101)
    found = [eval(E.text, {"__builtins__": {}}, {"abs": abs, "Z": x}) for x in z]
    assert np.allclose(found, np.interp(1.0 - z / 2.5, *np.array(table).T))


def test_a_parameter_of_three_numbers_is_of_one_kind() -> None:
    model = small(ksi1=[[0.0, 3.0], [1.0, 1.0]], zones={"all": 1.0}, ksi2=2.0, ksi3=1.0)
    fibres = model.materials[0].need("solid").all("solid")[1]
    assert fibres.need("ksi").type == "map" and fibres.need("ksi").text == "ksi1_all,ksi2_all,ksi3_all"
    assert np.allclose(rows(model, "ksi2_all"), 2.0)
    assert fibres.need("beta").text == "2,2,2" and fibres.need("beta").type is None
    law = lower(model).blocks[0].solid.solid[1]
    assert [type(v).__name__ for v in law.ksi] == ["Map"] * 3


def test_three_formulas_beside_each_other() -> None:
    model = small(ksi1=[[0.0, 3.0], [1.0, 1.0]], zones={"all": 1.0}, ksi2=2.0, ksi3=1.0, fields="formulas")
    ksi = model.materials[0].need("solid").children[2].need("ksi")
    assert (ksi.type, ksi.text) == ("math", "1+2*Z,2,1")
    law = lower(model).blocks[0].solid.solid[1]
    assert [type(v).__name__ for v in law.ksi] == ["Expression", "Constant", "Constant"]


def test_a_missing_map_among_three_is_named() -> None:
    model = small(ksi1=[[0.0, 3.0], [1.0, 1.0]], zones={"all": 1.0}, ksi2=2.0, ksi3=1.0)
    less = replace(model, mesh_data=tuple(d for d in model.mesh_data if d.name != "ksi2_all"))
    assert ['there is no map "ksi2_all"' in str(f) for f in check(less)] == [True]
    with pytest.raises(InputError, match='there is no map "ksi2_all"'):
        lower(less)


def test_fibres_turn_with_depth_and_follow_the_surface() -> None:
    model = small(fibres="families", azimuths=[0, 90], shape="curved", curvature=5.0, core_radius=0.8, zones={"a": 1.0},
                  fibre_angle=[[0.0, 0.0], [1.0, 90.0]])  # fmt: skip
    X, block = model.mesh.X, model.mesh.blocks[0]
    normal = X[block.conn].mean(axis=1) - [0.0, 0.0, 1.0 - 5.0]
    depth = 1.0 - (np.linalg.norm(normal, axis=1) - 4.0)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    for k in (1, 2):
        v = rows(model, f"fibre_{k}_a")
        assert np.allclose(np.linalg.norm(v, axis=1), 1.0)
        assert np.allclose(np.einsum("ei,ei->e", v, normal), np.sin(np.radians(90.0 * depth)), atol=0.02)
    assert len(model.materials[0].need("solid").all("solid")) == 3


# loads

def test_a_course_of_steps_and_of_cycles() -> None:
    common = {"rest": 0.0, "ramp": 2.0, "hold": 100.0, "times": [], "course": "steps", "steps": 2}
    made = course(common)
    assert made.points == [(0.0, 0.0), (2.0, 0.5), (102.0, 0.5), (104.0, 1.0), (204.0, 1.0)]
    assert made.times[0] == 0.0 and made.times[-1] == 204.0 and 102.0 in made.times
    assert (np.diff(made.times) > 0).all()
    made = course(common | {"course": "cyclic", "swing": 0.5, "cycles": 3, "frequency": 0.5})
    t, load = np.array(made.points).T
    assert t[-1] == pytest.approx(2.0 + 3 / 0.5)
    assert np.allclose(load[1:], 0.75 + 0.25 * np.sin(np.pi * (t[1:] - 2.0)), atol=1e-12)
    made = course(common | {"rest": 50.0})
    assert made.points[:2] == [(0.0, 0.0), (50.0, 0.0)] and made.times[0] == 0.0 and 50.0 in made.times
    with pytest.raises(InputError, match="begin with 0"):
        course(common | {"times": [1.0, 2.0]})


@pytest.mark.parametrize("tip", ["sphere", "cylinder"])
def test_an_indenter_touches_the_surface_on_the_axis(tip: str) -> None:
    model = small(shape="disc", pressed_by=tip, thickness=0.9)
    X = model.mesh.X[np.unique(model.mesh.surfaces["indenter_tip"].facets["quad4"])]
    r = np.linalg.norm(X[:, :2], axis=1)
    assert X[r.argmin()] == pytest.approx([0.0, 0.0, 0.9])
    if tip == "sphere":
        assert np.allclose(np.linalg.norm(X - [0.0, 0.0, 1.4], axis=1), 0.5)
    else:
        assert np.allclose(X[r < 0.4 - 1e-9, 2], 0.9) and X[:, 2].max() > 0.95
    q = model.mesh.X[model.mesh.surfaces["indenter_tip"].facets["quad4"]]
    assert (np.cross(q[:, 1] - q[:, 0], q[:, 2] - q[:, 1])[:, 2] < 0).all()
    names = conditions(model)
    assert "plate" not in names and "drained sides" in names and model.common.contact[0].type == "sliding-biphasic"
    assert model.steps[0].control is not None
    assert model.steps[0].control.need("solver").str("symmetric_stiffness") == "non-symmetric"


def test_what_moves_and_drains() -> None:
    column, disc = small(), small(shape="disc", quarter=True, compression=0.1, thickness=2.0, sticks=True)
    assert {"bone", "x_faces", "y_faces", "plate", "drained top"} == set(conditions(column))
    assert {"bone", "x_plane", "y_plane", "plate", "rough plate", "drained sides"} == set(conditions(disc))
    assert conditions(disc)["plate"].need("value").as_float() == pytest.approx(-0.2)


@pytest.mark.parametrize("given", [
    {}, {"shape": "disc", "fibres": "spherical"}, {"shape": "curved", "ground": "Holmes-Mow"},
    {"shape": "curved", "pressed_by": "plate", "fibres": "families"}, {"fields": "formulas", "E": [[0, 1], [1, 2]]},
    {"physics": "multiphasic", "course": "cyclic"},
    {"physics": "multiphasic", "shape": "disc", "pressed_by": "cylinder"},
])  # fmt: skip
def test_models_are_valid_and_solvable_and_survive_writing(given: dict[str, Any], tmp_path: Path) -> None:
    model = small(**given)
    write(model, tmp_path / "m.feb")
    assert [str(f) for f in validate(tmp_path / "m.feb")] == []
    back = read(tmp_path / "m.feb")
    lower(back)
    assert np.array_equal(back.mesh.X, model.mesh.X)
    for a, b in zip(back.mesh_data, model.mesh_data, strict=True):
        assert (a.name, a.set) == (b.name, b.set) and np.allclose(a.values, b.values, rtol=1e-12)


def test_settled_tissue_is_strained_as_one_over_its_modulus() -> None:
    """At rest stress is the same at all depths: strain = s/E, so u(d) = c ln(1.5/(0.5 + d))/ln 3 where E = 0.5 + d."""
    for fields in ("maps", "formulas"):
        model = small(
            layers=20, zones={"all": 1.0}, fibres="none", E=[[0.0, 0.5], [1.0, 1.5]], v=0.0, k0=1.0, M=0.0, phi0=0.2,
            compression=0.001, times=[0.0, 10.0, 1e4], fields=fields,
        )  # fmt: skip
        result = febkit.solve(model)
        assert result.converged
        d = 1.0 - model.mesh.X[:, 2]
        expected = -0.001 * np.log(1.5 / (0.5 + d)) / np.log(3.0)
        assert np.allclose(result.state.u[:, 2], expected, atol=1e-6)


# what FEBio 4.11 finds for the files that the template writes
TIGHT: dict[str, Any] = {"dtol": 1e-6, "etol": 1e-8, "ptol": 1e-6, "updates": 0}


def test_maps_of_all_properties_as_febio_solves_them() -> None:
    model = small(
        times=[0.0, 50.0, 100.0, 200.0, 2200.0], **TIGHT, E=[[0, 0.3], [1, 0.9]], v=[[0, 0.05], [1, 0.3]],
        k0=[[0, 4e-3], [1, 1e-3]], phi0=[[0, 0.1], [1, 0.3]], ksi1=[[0, 3], [1, 1]], ksi2=2.0, ksi3=[[0, 1], [1, 3]],
        fibre_beta=[[0, 2.0], [1, 2.5]], zones={"a": 1.0}, compression=0.1,
    )  # fmt: skip
    ds = febkit.Model.of(model).solve().dataset.sel(time=[100.0, 200.0, 2200.0])
    u = ds["displacement"].sel(xyz="z").values[:, ::5]
    assert np.allclose(u, FEBIO_COLUMN, atol=2e-8)
    p = ds["effective_fluid_pressure"].values[:, -1]
    assert p == pytest.approx([7.0897058e-2, 0.11903536, 2.20843e-5], rel=1e-5)


def test_indentation_as_febio_solves_it() -> None:
    """Fibres in families whose directions and moduli vary with depth, under a plane-ended cylinder."""
    model = small(
        times=[0.0, 50.0, 100.0, 200.0, 300.0], **TIGHT, fibres="families", ksi=[[0, 3], [1, 1]], shape="disc",
        quarter=True, pressed_by="cylinder", core=3,
    )  # fmt: skip
    ds = febkit.Model.of(model).solve().dataset
    force = ds["rigid_force"].values[:, -1, -1]
    assert force == pytest.approx([0.0, -0.00435821, -0.00812387, -0.01484996, -0.0114044], rel=2e-6, abs=1e-12)


FEBIO_COLUMN = [
    [-0.05, -0.03233062, -0.02157961, -0.01463041, -0.00673694, -0.00446601, -0.00283541, -0.00163786, 0.0],
    [-0.1, -0.06999575, -0.05001595, -0.03610187, -0.01859254, -0.01293486, -0.00856075, -0.00511128, 0.0],
    [-0.1, -0.08280963, -0.06818458, -0.05553136, -0.03468071, -0.02601203, -0.01830441, -0.01145027, 0.0],
]


# the published configuration

def test_the_published_column_has_its_values_at_its_elements() -> None:
    from febkit.templates.template import parameters_file

    template = load("cartilage")
    model, _ = template.build(template.values([parameters_file(EXAMPLE)]))
    X, blocks = model.mesh.X, model.mesh.blocks
    assert [len(b.conn) for b in blocks] == [25] * 100 and np.ptp(X, axis=0) == pytest.approx([0.05, 0.05, 0.5])
    z = np.array([X[b.conn, 2].mean() for b in blocks])
    h = z / z.max()  # as its program measures heights
    knots = [0.0, 0.1119, 0.2229, 0.3339, 0.4449, 0.5559, 0.6669, 0.7779, 0.8889, 1.0]
    v = [0.35812, 0.35812, 0.31904, 0.27997, 0.24089, 0.20181, 0.16273, 0.12366, 0.08458, 0.08458]
    found = [m.need("solid").children[1].float("v") for m in model.materials]
    assert np.allclose(found, np.interp(h, knots, v), atol=1e-7)
    ksi3 = [2.8] * 5 + [2.0] * 3 + [1.6] * 2
    found = [m.need("solid").children[2].need("ksi").as_floats(3)[2] for m in model.materials]
    assert np.allclose(found, np.interp(h, knots, ksi3), atol=1e-6)
    assert conditions(model)["plate"].need("value").as_float() == pytest.approx(-0.025)
    assert [t for t, _ in model.controllers[1].points][-2:] == [4.5, 5.0]


# what is refused

@pytest.mark.parametrize(("given", "words"), [
    ({"E": [1.0, 2.0]}, "2 numbers and there are 3 zones"),
    ({"E": "nowhere.csv"}, "cannot read nowhere.csv"),
    ({"M": [[0.0, 1.0], [1.0, 2.0]], "parts": "zones"}, "FEBio 4.11 takes one number of it for each material"),
    ({"E": [[0.0, 1.0], [1.0, 2.0]], "parts": "zones", "ground": "Holmes-Mow"}, "E varies within the part"),
    ({"zones": {}}, "at least one zone"), ({"zones": {"a": 0.5}}, "must end at depth 1"),
    ({"zones": {"a": 0.5, "b": 0.4}}, "b must end at a depth above 0.5"), ({"zones": {"a": "x"}}, "not 'x'"),
    ({"layers": 2}, "layers = 2: the superficial zone"), ({"shape": "curved", "curvature": 1.0}, "curvature = 1 mm"),
    ({"drained": ["left"]}, "no face 'left'"),
    ({"shape": "disc", "pressed_by": "cylinder", "edge_radius": 0.6}, "edge_radius"),
    ({"shape": "disc", "core_radius": 1.5}, "no room for rings"),
    ({"E": [[0.0, 0.0], [1.0, 1.0]]}, "greater than 0"), ({"phi0": 1.0}, "less than 1"),
    ({"fibre_beta": 1.5}, "at least 2"),
    ({"times": [1.0, 2.0]}, "begin with 0"), ({"shape": "cone"}, "one of column, disc, curved"),
])  # fmt: skip
def test_bad_values_are_refused(given: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        small(**given)


def test_what_only_the_layer_can_tell_names_the_file_too() -> None:
    template = load("cartilage")
    for given in ({"E": [1.0, 2.0]}, {"M": [[0.0, 1.0], [1.0, 2.0]], "parts": "zones"}):
        with pytest.raises(InputError) as e:
            template.build(template.values([(given, Where("mine.toml"))]))
        assert str(e.value).startswith("mine.toml: ")
