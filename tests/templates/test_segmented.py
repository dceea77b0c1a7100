"""Tetrahedra in segmented images and closed surfaces, through gmsh."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import febkit
from febkit.feb import validate, write
from febkit.metrics import cell_metrics
from febkit.model import InputError
from febkit.model.elements import ELEMENTS
from febkit.templates import new
from febkit.templates.quality import judge, volumes

SURFACES = {"stl": "", "coarse": "_coarse"}
RADII = {1: 0.010, 2: 0.007, 3: 0.005}  # of ECM, PCM, cell (mm)


def image(n: int) -> np.ndarray:
    """Labels of three balls, one in the other, in voxels of 0.02/(n - 4) mm."""
    h = 0.02 / (n - 4)
    x = (np.arange(n) - (n - 1) / 2) * h
    r = np.sqrt(x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2)
    labels = np.zeros((n, n, n), dtype=np.uint8)
    for label, radius in RADII.items():
        labels[r < radius] = label
    return labels


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("gmsh", reason="the mesher of febkit[tets] is not installed", exc_type=ImportError)
    pv = pytest.importorskip("pyvista")
    folder = tmp_path_factory.mktemp("segmented")
    np.save(folder / "balls.npy", image(28))
    np.save(folder / "few.npy", image(14))
    from PIL import Image

    pages = [Image.fromarray(page) for page in image(14).transpose(2, 1, 0)]
    pages[0].save(folder / "balls.tif", save_all=True, append_images=pages[1:])
    for name, radius in (("ecm", 1.0), ("pcm_1", 0.7), ("cell_1", 0.5)):
        pv.Icosphere(radius=radius, nsub=3).save(folder / f"{name}.stl")
        pv.Icosphere(radius=radius, nsub=2).save(folder / f"{name}_coarse.stl")
    return folder


def made(kind: str, files: Path, **more: Any) -> Any:
    if kind in SURFACES:
        names = {n: str(files / f"{n}{SURFACES[kind]}.stl") for n in ("ecm", "pcm_1", "cell_1")}
        return new("chondron", surfaces=names, scale=0.01, **more)
    file, n = {"npy": ("balls.npy", 28), "tif": ("balls.tif", 14), "few": ("few.npy", 14)}[kind]
    given: dict[str, Any] = {"mesh_file": str(files / file), "voxel": [0.02 / (n - 4)] * 3}
    return new("chondron", **given, **more)


@pytest.mark.parametrize("kind", ["npy", "stl"])
def test_balls_within_balls(kind: str, files: Path) -> None:
    mesh = made(kind, files).mesh
    solids = [b for b in mesh.blocks if b.type == "tet4"]
    assert [b.name for b in solids] == ["ecm", "pcm_1", "cell_1"]
    assert judge(mesh.X, [(b.type, b.conn) for b in solids]).scaled_jacobian_min > 0.05
    size = [float(volumes(mesh.X, b.type, b.conn).sum()) for b in solids]
    exact = [4 / 3 * np.pi * (RADII[k] ** 3 - RADII.get(k + 1, 0.0) ** 3) for k in (1, 2, 3)]
    assert np.allclose(size, exact, rtol=0.03)
    membrane = next(b for b in mesh.blocks if b.name == "membrane_1")
    assert membrane.type == "tri3" and len(mesh.surfaces["cell_1_surface"].facets["tri3"]) == len(membrane.conn)
    shared = np.intersect1d(solids[2].conn, solids[1].conn)
    assert np.array_equal(np.unique(membrane.conn), shared)  # conforming: nodes of the surface are of both


def test_a_tiff_is_the_array_it_holds(files: Path) -> None:
    one, two = (made(kind, files).mesh for kind in ("few", "tif"))
    assert np.allclose(one.X, two.X)


def test_quadratic_tetrahedra(files: Path) -> None:
    mesh = made("coarse", files, tets="tet10").mesh
    ecm = mesh.blocks[0]
    assert ecm.type == "tet10"
    x = mesh.X[ecm.conn]
    for k, (a, b) in enumerate(((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)), 4):
        assert np.allclose(x[:, k], (x[:, a] + x[:, b]) / 2)
    assert len(np.unique(mesh.X, axis=0)) == len(mesh.X)
    assert next(b for b in mesh.blocks if b.name == "membrane_1").type == "tri6"


def image_of_two(n: int = 18) -> np.ndarray:
    """Two cells (3, 4) in one PCM (2) in a block (1), in voxels."""
    x = np.arange(n) - (n - 1) / 2
    flat = x[None, :, None] ** 2 + x[None, None, :] ** 2
    labels = np.zeros((n, n, n), dtype=np.uint8)
    labels[1:-1, 1:-1, 1:-1] = 1
    labels[(x[:, None, None] / 7.5) ** 2 + flat / 25 < 1] = 2
    for label, middle in ((3, -3.5), (4, 3.5)):
        labels[(x[:, None, None] - middle) ** 2 + flat < 2.4**2] = label
    return labels


def facets_of(blocks: Any) -> Counter[frozenset[int]]:
    """How many elements have each facet, by its nodes."""
    return Counter(frozenset(facet) for b in blocks for _, local in ELEMENTS[b.type].facets
                   for facet in b.conn[:, local].tolist())


@pytest.mark.parametrize("kind", ["few", "coarse"])
def test_wedges_around_a_cell(kind: str, files: Path) -> None:
    mesh = made(kind, files, tets="hybrid", wedges=3, wedge_share=0.3).mesh
    solids = [b for b in mesh.blocks if b.name != "membrane_1"]
    assert [(b.name, b.type) for b in solids] == [("ecm", "tet4"), ("pcm_1_tet4", "tet4"), ("pcm_1_penta6", "penta6"),
                                                  ("cell_1", "tet4")]
    surface = mesh.surfaces["cell_1_surface"].facets["tri3"]
    assert len(solids[2].conn) == 3 * len(surface)
    times, outer = facets_of(solids), {frozenset(t) for t in mesh.surfaces["outer"].facets["tri3"].tolist()}
    assert {f for f, n in times.items() if n == 1} == outer and max(times.values()) == 2  # conforming
    assert len(np.unique(np.concatenate([b.conn.ravel() for b in solids]))) == len(mesh.X)
    size = {b.name: float(volumes(mesh.X, b.type, b.conn).sum()) for b in solids}
    whole = {b.name: float(volumes(mesh.X, b.type, b.conn).sum()) for b in made(kind, files).mesh.blocks[:3]}
    assert size["pcm_1_tet4"] + size["pcm_1_penta6"] == pytest.approx(whole["pcm_1"], rel=1e-12)
    thick = np.linalg.norm(mesh.X[solids[2].conn[:, 3:]] - mesh.X[solids[2].conn[:, :3]], axis=2)
    assert np.allclose(thick, 0.3 / 3 * 0.002, rtol=0.25)  # of a PCM of 0.002 mm
    assert np.array_equal(np.sort(mesh.element_sets["pcm_1"].elements), np.sort(np.r_[solids[1].ids, solids[2].ids]))
    outside = np.linalg.norm(mesh.X[mesh.surfaces["pcm_1_surface"].facets["tri3"]], axis=2)
    assert outside.min() > 0.006  # and none between wedges and tetrahedra, at 0.0056
    assert next(b for b in mesh.blocks if b.name == "membrane_1").conn.shape == surface.shape


def test_two_cells_in_one_pcm_have_wedges_each(files: Path) -> None:
    np.save(files / "two.npy", image_of_two())
    model = new("chondron", mesh_file=str(files / "two.npy"), voxel=[0.001] * 3, tets="hybrid", wedges=1)
    found = {b.name: len(b.conn) for b in model.mesh.blocks}
    assert found["pcm_1_penta6"] == sum(len(model.mesh.surfaces[f"cell_1_{k}_surface"].facets["tri3"]) for k in (1, 2))


@pytest.mark.parametrize("tets", ["tet4", "hybrid"])
def test_what_is_made_is_solved(tets: str, files: Path, tmp_path: Path) -> None:
    write(made("few", files, times=[0, 0.5], ramp=0.5, first_step=0.5, tets=tets), tmp_path / "balls.feb")
    assert not [f for f in validate(tmp_path / "balls.feb", solvable=True) if f.severity in ("error", "unsupported")]
    result = febkit.read(tmp_path / "balls.feb").solve()
    assert result.converged
    assert cell_metrics(result.dataset, febkit.read(tmp_path / "balls.feb"))["cell"].values.tolist() == ["cell_1"]


@pytest.mark.parametrize(("given", "words"), [
    ({"voxel": []}, "set voxel"), ({"voxel": [1.0, 1.0]}, "set voxel"),
    ({"mesh_file": "float.npy"}, "whole numbers in three dimensions"), ({"mesh_file": "one.npy"}, "no surface"),
    ({"mesh_file": "none.npy"}, "cannot read the image"), ({"mesh_file": "text.tif"}, "cannot read the image"),
    ({"surfaces": {"ecm": "open.stl"}}, "surface of ecm is not closed"),
    ({"surfaces": {"ecm": "none.stl"}}, "cannot read the surface of ecm"),
    ({"surfaces": {"bone": "ecm.stl"}}, "templates know parts named"),
    ({"surfaces": {"ecm": "ecm.stl"}, "tets": "hybrid"}, "here is none"),
    ({"tets": "hybrid", "wedge_share": 0.6}, "wedge_share"),
])  # fmt: skip
def test_what_cannot_be_is_refused(given: dict[str, Any], words: str, files: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(files)
    np.save("float.npy", np.ones((4, 4, 4)))
    np.save("one.npy", np.ones((4, 4, 4), dtype=int))
    Path("text.tif").write_text("no image")
    meshio.Mesh(np.eye(3), [("triangle", [[0, 1, 2]])]).write("open.stl")
    with pytest.raises(InputError, match=words):
        new("chondron", **{"mesh_file": "balls.npy", "voxel": [1.0, 1.0, 1.0], **given})


def test_without_the_mesher(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setitem(sys.modules, "gmsh", None)
    np.save(tmp_path / "balls.npy", image(12))
    pytest.importorskip("pyvista")
    with pytest.raises(InputError, match=r'need gmsh: pip install "febkit\[tets\]"'):
        new("chondron", mesh_file=str(tmp_path / "balls.npy"), voxel=[0.001] * 3)
