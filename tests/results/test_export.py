"""Plotfiles to ParaView and NetCDF; meshio's reading and writing."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import meshio
import numpy as np
import pytest

import febkit.meshio_format as fm
from febkit import results
from febkit.model import InputError
from febkit.results.cells import FEBIO, MESHIO, ORDER
from febkit.results.export import export


@pytest.fixture
def plot(tmp_path: Path, make_modern) -> Path:
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern())
    return path


def test_series_holds_every_state_and_variable(plot: Path) -> None:
    files = export(plot, plot.with_suffix(".pvd"))
    entries = ET.parse(files[0]).getroot().findall("Collection/DataSet")
    assert [(float(e.get("timestep")), e.get("part")) for e in entries] == [
        (t, p) for t in (0.0, 0.1, 0.2) for p in ("0", "1")
    ]
    for t in range(3):
        body = meshio.read(plot.with_name(f"a_{t:04d}.vtu"))
        np.testing.assert_array_equal(body.point_data["displacement"], (10 * t + np.arange(36)).reshape(12, 3))
        np.testing.assert_array_equal(body.point_data["effective_fluid_pressure"], 100 * t + np.arange(12))
        stress = np.concatenate(body.cell_data["stress"])
        np.testing.assert_array_equal(stress, 1000 * t + np.arange(12).reshape(2, 6))
        np.testing.assert_array_equal(np.concatenate(body.cell_data["part"]), [0, 1])
        face = meshio.read(plot.with_name(f"a_{t:04d}_surfaces.vtu"))
        assert {c.type: len(c.data) for c in face.cells} == {"triangle": 1, "quad": 1}
        gap = dict(zip((c.type for c in face.cells), face.cell_data["contact_gap"]))
        assert (gap["quad"].item(), gap["triangle"].item()) == (2.5, 6.0)  # means over 4 and 3 nodes


def test_deformed_points_and_chosen_variables(plot: Path) -> None:
    export(plot, plot.with_name("b.vtu"), variables=("displacement",), deformed=True)
    m = meshio.read(plot.with_name("b_0001.vtu"))
    reference = results.open(plot)["X"].values
    np.testing.assert_array_equal(m.points, reference + (10 + np.arange(36)).reshape(12, 3))
    assert set(m.cell_data) == {"element_id", "part"}
    with pytest.raises(InputError, match='no variable "wrong"; there are displacement'):
        export(plot, plot.with_name("c.vtu"), variables=("wrong",))


def test_mean_of_values_at_element_nodes(tmp_path: Path, random_plot) -> None:
    random_plot(tmp_path / "a.xplt", 11, 1)
    export(tmp_path / "a.xplt", tmp_path / "a.pvd")
    ds = results.open(tmp_path / "a.xplt")
    m = meshio.read(tmp_path / "a_0000.vtu")
    np.testing.assert_allclose(
        np.concatenate(m.cell_data["domain_mult_vec3f"]), ds["domain_mult_vec3f"][0].mean("local"), rtol=1e-6
    )
    region = ds["domain_region_float"][0].values[ds["part"].values]
    np.testing.assert_array_equal(np.concatenate(m.cell_data["domain_region_float"]), region)


def test_netcdf_target(plot: Path) -> None:
    export(plot, plot.with_suffix(".nc"), variables=("stress",))
    back = results.open(plot.with_suffix(".nc"))
    np.testing.assert_array_equal(back["stress"][2], 2000 + np.arange(12).reshape(2, 6))
    assert list(back.data_vars) == ["stress"]
    export(plot.with_suffix(".nc"), plot.with_name("back.xplt"))
    np.testing.assert_array_equal(results.open(plot.with_name("back.xplt"))["stress"], back["stress"])


def test_unknown_target(plot: Path) -> None:
    with pytest.raises(InputError, match="results are converted from"):
        export(plot, plot.with_suffix(".stl"))


def test_meshio_reads_the_last_state(plot: Path) -> None:
    m = meshio.read(plot)
    np.testing.assert_array_equal(m.point_data["displacement"], (20 + np.arange(36)).reshape(12, 3))
    np.testing.assert_array_equal(m.point_sets["fix"], [0, 1])
    assert [c.type for c in m.cells] == ["hexahedron", "hexahedron"]


def test_hex27_faces_are_reordered() -> None:
    """FEBio's face nodes lie at -y +x +y -x -z +z; VTK wants -x +x -y +y -z +z."""
    faces = {20: (0, -1, 0), 21: (1, 0, 0), 22: (0, 1, 0), 23: (-1, 0, 0), 24: (0, 0, -1), 25: (0, 0, 1)}
    vtk = [faces[i] for i in ORDER["hex27"][20:26]]
    assert vtk == [(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1)]


def test_tables_of_cells_agree() -> None:
    assert all(MESHIO[f] == m for m, f in FEBIO.items())
    counts = meshio._common.num_nodes_per_cell
    from febkit.results.cells import KEPT
    from febkit.results.xplt import tags

    for name, nodes in tags.ELEMENT_TYPES:
        assert counts[MESHIO[name]] == KEPT.get(name, nodes)


def example() -> meshio.Mesh:
    points = np.array([[x, y, z] for x in (0, 1, 2) for y in (0, 1) for z in (0, 1)], float)
    hexes = np.array([[0, 4, 6, 2, 1, 5, 7, 3], [4, 8, 10, 6, 5, 9, 11, 7]])
    return meshio.Mesh(
        np.vstack([points, [[9, 9, 9]]]),  # one point that no element uses
        [("hexahedron", hexes), ("quad", np.array([[0, 4, 5, 1], [4, 8, 9, 5]]))],
        point_sets={"fix": np.array([0, 1, 12])},
        cell_sets={"soft": [np.array([0]), np.array([], int)], "stiff": [np.array([1]), np.array([], int)],
                   "front": [np.array([], int), np.array([0, 1])], "both": [np.array([0, 1]), np.array([], int)]},
    )


def test_model_from_a_mesh_with_sets() -> None:
    mesh = example()
    del mesh.cell_sets["both"]
    model = fm.to_model(mesh)
    assert [(b.name, b.type, b.ids.tolist()) for b in model.mesh.blocks] == [
        ("soft", "hex8", [1]), ("stiff", "hex8", [2])
    ]
    assert len(model.mesh.node_ids) == 12
    np.testing.assert_array_equal(model.mesh.node_sets["fix"].nodes, [0, 1])
    np.testing.assert_array_equal(model.mesh.surfaces["front"].facets["quad4"], [[0, 4, 5, 1], [4, 8, 9, 5]])
    assert model.materials[0].type == "neo-Hookean"
    assert {d.material for d in model.domains} == {"material1"}


@pytest.mark.parametrize("suffix", [".inp", ".vtk", ".msh"])
def test_other_formats_to_feb(tmp_path: Path, suffix: str) -> None:
    mesh = example()
    mesh.points = mesh.points[:12]
    mesh.point_sets = {"fix": np.array([0, 1])} if suffix == ".inp" else {}
    mesh.cell_sets = {k: v for k, v in mesh.cell_sets.items() if k != "both"} if suffix == ".inp" else {}
    options = {}
    if suffix == ".msh":
        mesh.cell_data = {"gmsh:physical": [np.array([1, 2]), np.array([5, 5])],
                          "gmsh:geometrical": [np.array([1, 2]), np.array([5, 5])]}
        mesh.field_data = {"soft": np.array([1, 3]), "stiff": np.array([2, 3]), "front": np.array([5, 2])}
        options = {"file_format": "gmsh22"}
    mesh.write(tmp_path / f"a{suffix}", **options)
    model = fm.to_model(fm.read_mesh(tmp_path / f"a{suffix}"))
    feb = tmp_path / "a.feb"
    fm.write_feb(feb, fm.read_mesh(tmp_path / f"a{suffix}"))
    from febkit.feb import read

    back = read(feb)
    np.testing.assert_allclose(back.mesh.X, mesh.points)
    assert [b.name for b in back.mesh.blocks] == [b.name for b in model.mesh.blocks]
    if suffix != ".vtk":
        assert {b.name for b in back.mesh.blocks} == {"soft", "stiff"}
        np.testing.assert_array_equal(back.mesh.surfaces["front"].facets["quad4"], [[0, 4, 5, 1], [4, 8, 9, 5]])
    assert back.materials[0].float("E") == 1.0
    assert back.steps[0].control is not None


def test_feb_through_meshio_and_back(tmp_path: Path) -> None:
    fm.write_feb(tmp_path / "a.feb", example())
    m = meshio.read(tmp_path / "a.feb")
    m.write(tmp_path / "b.feb")
    again = meshio.read(tmp_path / "b.feb")
    np.testing.assert_array_equal(again.points, m.points)
    assert set(again.cell_sets) == set(m.cell_sets)
    for a, b in zip(m.cells, again.cells):
        assert a.type == b.type
        np.testing.assert_array_equal(a.data, b.data)


def test_unreadable_mesh_is_an_input_error(tmp_path: Path) -> None:
    (tmp_path / "a.msh").write_text("not a mesh")
    with pytest.raises(InputError, match="meshio cannot read"):
        fm.read_mesh(tmp_path / "a.msh")
