"""Meshes of a user's own, written and read back through meshio."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit.metrics import cell_metrics
from febkit.model import InputError
from febkit.templates import new
from febkit.templates.cell_cube import cell_cube
from febkit.templates.elements import filled
from febkit.templates.quality import volumes
from febkit.templates.template import load
from febkit.templates.tissue_cube import tissue_planes
from febkit.templates.user_mesh import user_mesh

meshio = pytest.importorskip("meshio")


def cells_on_disk(path: Path, name: str, turn: bool = False) -> Any:
    """A small cell cube in micrometres, with part numbers in an element array."""
    from febkit.model import Where

    cube = cell_cube(load("cell").values([({"n": 9, "cells": 2, "layers": [1, 1, 1]}, Where())]))
    mesh = cube.mesh
    conn = np.concatenate([c for _, c in mesh.parts.values()])
    number = np.concatenate([np.full(len(c), 10 + i) for i, (_, c) in enumerate(mesh.parts.values())])
    if turn:
        conn = conn.copy()
        conn[::3] = conn[::3][:, [4, 5, 6, 7, 0, 1, 2, 3]]
    meshio.Mesh(mesh.X * 1000.0, [("hexahedron", conn)], cell_data={name: [number]}).write(path)
    return mesh


@pytest.mark.parametrize("turn", [False, True])
def test_parts_are_told_from_outside_in(tmp_path: Path, turn: bool) -> None:
    made = cells_on_disk(tmp_path / "m.vtk", "part", turn)
    read = user_mesh(tmp_path / "m.vtk", {}, scale=0.001)
    assert ({k: len(v[1]) for k, v in read.parts.items()}
            == {k: len(v[1]) for k, v in made.parts.items()})
    assert list(read.parts) == ["ecm", "pcm_1", "pcm_2", "cell_1", "cell_2"]
    assert np.allclose(read.X, made.X)


def test_a_whole_model_of_ones_own_cells(tmp_path: Path) -> None:
    cells_on_disk(tmp_path / "m.vtu", "tissue_type")
    model = new("cell", mesh_file=str(tmp_path / "m.vtu"), part_array="tissue_type", scale=0.001,
                part_names={"10": "ecm", "11": "pcm_1", "12": "pcm_2", "13": "cell_1", "14": "cell_2"})
    assert [(d.block, d.material) for d in model.domains] == [
        ("ecm", "ecm"), ("pcm_1", "pcm"), ("pcm_2", "pcm"),
        ("cell_1", "chondrocyte"), ("cell_2", "chondrocyte")]
    assert {"top", "bottom", "outer", "cell_1_surface", "pcm_2_surface"} <= set(model.mesh.surfaces)
    assert model.mesh.part_lists["cells"] == ("cell_1", "cell_2")


@pytest.mark.parametrize("kind", ["tetra", "tetra10", "hexahedron20", "wedge"])
def test_other_elements(tmp_path: Path, kind: str) -> None:
    own = {"tetra": "tet4", "tetra10": "tet10", "hexahedron20": "hex20", "wedge": "penta6"}[kind]
    X, conn = filled((tissue_planes(3, 1.0, 0.0),) * 3, own)
    meshio.Mesh(X, [(kind, conn)]).write(tmp_path / "m.vtk")
    model = new("tissue", mesh_file=str(tmp_path / "m.vtk"), case="C")
    block = model.mesh.blocks[0]
    assert (block.name, block.type, len(block.conn)) == ("ecm", own, len(conn))
    top = np.unique(np.concatenate([c.ravel() for c in model.mesh.surfaces["top"].facets.values()]))
    assert np.array_equal(top, model.mesh.node_sets["top"].nodes)
    assert np.allclose(model.mesh.X[top, 2], 0.5)


def test_loose_nodes_and_surface_elements_are_left_out(tmp_path: Path) -> None:
    X, conn = filled((tissue_planes(1, 1.0, 0.0),) * 3, "hex8")
    X = np.concatenate([[[9.0, 9.0, 9.0]], X])
    meshio.Mesh(X, [("quad", conn[:, :4] + 1), ("hexahedron", conn + 1)]).write(tmp_path / "m.vtk")
    read = user_mesh(tmp_path / "m.vtk", {})
    assert len(read.X) == 8 and read.elements == 1


@pytest.mark.parametrize(("names", "array", "words"), [
    ({"10": "ecm"}, "part", "have no name"), ({}, "nothing", "no element array"),
])
def test_unclear_parts_are_refused(tmp_path: Path, names: dict[str, str], array: str, words: str) -> None:
    cells_on_disk(tmp_path / "m.vtk", "part")
    with pytest.raises(InputError, match=words):
        user_mesh(tmp_path / "m.vtk", names, array)


def test_a_part_no_template_knows_is_refused(tmp_path: Path) -> None:
    X, conn = filled((tissue_planes(1, 1.0, 0.0),) * 3, "hex8")
    meshio.Mesh(X, [("hexahedron", conn)], cell_data={"part": [np.array([3])]}).write(tmp_path / "m.vtk")
    with pytest.raises(InputError, match="bone"):
        new("cell", mesh_file=str(tmp_path / "m.vtk"), part_names={"3": "bone"})


def test_files_that_are_no_solid_mesh(tmp_path: Path) -> None:
    meshio.Mesh(np.eye(3), [("triangle", np.array([[0, 1, 2]]))]).write(tmp_path / "s.vtk")
    with pytest.raises(InputError, match="no solid elements"):
        user_mesh(tmp_path / "s.vtk", {})
    with pytest.raises(InputError, match="cannot read"):
        user_mesh(tmp_path / "missing.vtk", {})


def test_crushed_elements_are_refused(tmp_path: Path) -> None:
    X, conn = filled((tissue_planes(1, 1.0, 0.0),) * 3, "hex8")
    X[6] = [-0.6, -0.6, -0.6]
    meshio.Mesh(X, [("hexahedron", conn)]).write(tmp_path / "m.vtk")
    with pytest.raises(InputError, match="not positive"):
        user_mesh(tmp_path / "m.vtk", {})


def pyramids_in_a_lattice(path: Path) -> None:
    """4 x 3 x 3 cubes of 0.01 mm; the two in the middle are the cell, one of them in six pyramids."""
    X, conn = filled((np.linspace(-0.02, 0.02, 5), *(np.linspace(-0.015, 0.015, 4),) * 2), "hex8")
    middle = X[conn].mean(axis=1)
    cell = (np.abs(middle) < 0.006).all(axis=1)
    right = cell & (middle[:, 0] > 0)
    apex = len(X)
    base = [[0, 1, 2, 3], [7, 6, 5, 4], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]
    pyramids = np.array([[*conn[right][0][b], apex] for b in base])
    pyramids[::2] = pyramids[::2][:, [3, 2, 1, 0, 4]]  # turned inside out, which is put right
    part = np.where(cell, 2, 1)[~right]
    meshio.Mesh(np.concatenate([X, middle[right]]), [("hexahedron", conn[~right]), ("pyramid", pyramids)],
                cell_data={"part": [part, np.full(6, 2)]}).write(path)


def test_a_cell_of_hexahedra_and_pyramids_is_one_cell(tmp_path: Path) -> None:
    pyramids_in_a_lattice(tmp_path / "m.vtk")
    model = new("cell", mesh_file=str(tmp_path / "m.vtk"), part_names={"1": "ecm", "2": "cell_1"}, times=[0, 0.1],
                membrane_thickness=1e-5)
    mesh = model.mesh
    assert [(b.name, b.type) for b in mesh.blocks] == [
        ("ecm", "hex8"), ("cell_1_hex8", "hex8"), ("cell_1_pyra5", "pyra5"), ("membrane_1", "quad4")]
    assert {k: float(volumes(mesh.X, k, mesh.block(f"cell_1_{k}").conn).sum()) for k in ("hex8", "pyra5")} == (
        pytest.approx({"hex8": 1e-6, "pyra5": 1e-6}))
    assert {k: len(c) for k, c in mesh.surfaces["cell_1_surface"].facets.items()} == {"quad4": 10}
    febkit.write(model, tmp_path / "m.feb")
    with pytest.warns(UserWarning, match='material "pcm" belongs to no domain'):
        result = febkit.read(tmp_path / "m.feb").solve()
    found = cell_metrics(result.dataset, febkit.read(tmp_path / "m.feb"))
    assert result.converged and found["cell"].values.tolist() == ["cell_1"]


@pytest.mark.parametrize("template", ["cell", "chondron", "embedded"])
def test_types_of_elements_that_nothing_makes_are_refused(template: str, tmp_path: Path) -> None:
    """Not left aside: hexahedra in their place would be found late."""
    with pytest.raises(InputError, match="the generated mesh is of hexahedra"):
        new(template, tets="hybrid")
    pyramids_in_a_lattice(tmp_path / "m.vtk")
    with pytest.raises(InputError, match=r"m\.vtk is a mesh, whose elements are taken as they are"):
        new(template, tets="tet10", mesh_file=str(tmp_path / "m.vtk"))
