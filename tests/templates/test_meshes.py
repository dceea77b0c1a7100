"""The study's meshes: conforming, sound, with exact spheres and the sizes asked for."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest

from febkit.model import InputError
from febkit.templates.cell_cube import cell_cube, volume_report
from febkit.templates.cells import make_chondrons
from febkit.templates.coarsening import Skin, around
from febkit.templates.elements import FILLS, filled
from febkit.templates.embedded_cube import embedded_cube
from febkit.templates.facets import FACETS, between_parts, select
from febkit.templates.lattice import skin_index, skin_quads, spaced
from febkit.templates.ogrid import pattern
from febkit.templates.parts import Parts
from febkit.templates.quality import aspect, jacobians, judge, scaled_jacobian, volumes
from febkit.templates.template import load
from febkit.templates.tissue_cube import tissue_cube, tissue_planes

UNIT_CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0],
                      [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)


def values(name: str, **given: Any) -> dict[str, Any]:
    from febkit.model import Where

    return load(name).values([(given, Where())])


def outer_quads(mesh: Parts) -> np.ndarray:
    facets = between_parts(list(mesh.parts.values()), len(mesh.X))
    return select(facets, np.arange(len(mesh.parts)))["quad4"]


def total_volume(mesh: Parts) -> float:
    return float(sum(volumes(mesh.X, kind, conn).sum() for kind, conn in mesh.parts.values()))


def assert_conforming(mesh: Parts, edge: float) -> None:
    """Every inner face is shared by two elements, so what is left over lies on the cube's faces alone."""
    quads = outer_quads(mesh)
    on_face = np.isclose(np.abs(mesh.X[quads]), edge / 2.0, rtol=0, atol=1e-12).all(axis=1).any(axis=1)
    assert on_face.all()
    x = mesh.X[quads]
    area = np.linalg.norm(np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]), axis=1).sum() / 2.0
    assert area == pytest.approx(6.0 * edge**2, rel=1e-12)
    assert total_volume(mesh) == pytest.approx(edge**3, rel=1e-12)
    used = np.unique(np.concatenate([conn.ravel() for _, conn in mesh.parts.values()]))
    assert np.array_equal(used, np.arange(len(mesh.X)))
    assert len(np.unique(np.round(mesh.X / edge, 10), axis=0)) == len(mesh.X)  # no node twice


# tissue

def test_tissue_of_the_study() -> None:
    mesh = tissue_cube(values("tissue"))
    assert mesh.elements == 42875
    x = np.unique(mesh.X[:, 0])
    steps = np.diff(x)
    assert steps[17] == pytest.approx(0.2)
    assert np.allclose(np.delete(steps, 17), 0.8 / 34)
    assert_conforming(mesh, 1.0)


def test_tissue_with_more_elements_in_height() -> None:
    mesh = tissue_cube(values("tissue", n=5, vertical=9))
    assert mesh.elements == 5 * 5 * 9
    assert_conforming(mesh, 1.0)
    assert np.allclose(np.unique(mesh.X[:, 2]), tissue_planes(9, 1.0, 0.2))


def test_graded_planes_keep_centre_and_ratio() -> None:
    x = tissue_planes(11, 1.0, 0.3, ratio=0.25)
    assert x[0] == -0.5 and x[-1] == 0.5
    assert np.allclose(x, -x[::-1])
    steps = np.diff(x)
    assert steps[5] == pytest.approx(0.3)
    assert steps[-1] / steps[6] == pytest.approx(0.25)


@pytest.mark.parametrize(("n", "centre"), [(10, 0.2), (35, 1.0)])
def test_tissue_refuses_what_cannot_be(n: int, centre: float) -> None:
    with pytest.raises(InputError):
        tissue_planes(n, 1.0, centre)


@pytest.mark.parametrize("kind", FILLS)
def test_other_elements_fill_the_cube(kind: str) -> None:
    X, conn = filled((tissue_planes(5, 1.0, 0.2),) * 3, kind)
    assert volumes(X, kind, conn).sum() == pytest.approx(1.0)
    assert jacobians(X, kind, conn).min() > 0
    surface = select(between_parts([(kind, conn)], len(X)), np.array([0]))
    for facets in surface.values():
        x = X[facets]
        assert (np.abs(np.abs(x) - 0.5) < 1e-12).all(axis=1).any(axis=1).all()  # mid-edge nodes too
        normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 1])
        assert (np.einsum("fi,fi->f", normal, x[:, 0]) > 0).all()  # outwards


@pytest.mark.parametrize("kind", [k for k in FACETS if k not in ("hex8", "tet4", "penta6", "pyra5")])
def test_middle_nodes_of_facets_lie_in_the_middle(kind: str) -> None:
    X, conn = filled((tissue_planes(1, 1.0, 0.0),) * 3, kind)
    for local in FACETS[kind]:
        corners = 4 if len(local) > 6 else 3
        x = X[conn[0, list(local)]]
        for m in range(corners):
            assert np.allclose(x[corners + m], (x[m] + x[(m + 1) % corners]) / 2.0)


# cell cube

@pytest.fixture(scope="module")
def study_cells() -> Any:
    return cell_cube(values("cell"))


def test_cell_cube_of_the_study(study_cells: Any) -> None:
    mesh = study_cells.mesh
    assert mesh.elements == pytest.approx(97725, rel=0.01)
    assert_conforming(mesh, 0.1)
    quality = judge(mesh.X, list(mesh.parts.values()))
    assert quality.jacobian_min > 0.5
    assert quality.scaled_jacobian_min > 0.3
    assert quality.scaled_jacobian_median > 0.9
    assert quality.aspect_max < 6


@pytest.mark.parametrize("layers", [(3, 2, 2), (1, 1, 1), (2, 3, 4)])
def test_small_cell_cubes(layers: tuple[int, int, int]) -> None:
    cube = cell_cube(values("cell", n=12, layers=list(layers)))
    assert_conforming(cube.mesh, 0.1)
    assert cube.mesh.elements == 12**3 + 11 * 54 * sum(layers)
    assert min(jacobians(cube.mesh.X, *p).min() for p in cube.mesh.parts.values()) > 0


def test_surfaces_of_cells_and_pcm_are_spheres(study_cells: Any) -> None:
    mesh = study_cells.mesh
    for c in range(11):
        cell, pcm = mesh.parts[f"cell_{c + 1}"][1], mesh.parts[f"pcm_{c + 1}"][1]
        r = np.linalg.norm(mesh.X - study_cells.places.centres[c], axis=1)
        inner = np.intersect1d(cell, pcm)
        outer = np.intersect1d(pcm, mesh.parts["ecm"][1])
        assert np.allclose(r[inner], 0.005, rtol=1e-12)
        assert np.allclose(r[outer], 0.0075, rtol=1e-12)
        assert r[cell].max() == pytest.approx(0.005)


def test_volume_fractions_approach_the_spheres_at_second_order() -> None:
    missing = []
    for block, n in ((4, 18), (8, 36), (16, 72)):
        p = values("cell", n=n, block=block, centres=[[0.0, 0.0, 0.0]], layers=[2, 2, 2], cells=1)
        cube = cell_cube(p)
        v = volume_report(cube.mesh, cube.cells, 0.1**3)
        missing.append(1.0 - v["cell volume fraction"] / v["exact cell volume fraction"])
        assert v["exact PCM volume fraction"] == pytest.approx(4 / 3 * np.pi * (7.5**3 - 5**3) / 100**3)
    rates = np.log2(np.array(missing[:-1]) / missing[1:])
    assert np.allclose(rates, 2.0, atol=0.1)
    assert missing[-1] < 0.005


def test_the_same_seed_gives_the_same_mesh_and_another_another() -> None:
    a, b, c = (cell_cube(values("cell", n=12, layers=[1, 1, 1], seed=s)) for s in (3, 3, 4))
    assert np.array_equal(a.mesh.X, b.mesh.X)
    assert not np.array_equal(a.places.centres, c.places.centres)


@pytest.mark.parametrize("seed", range(6))
def test_blocks_do_not_overlap(seed: int) -> None:
    p = cell_cube(values("cell", n=15, layers=[1, 1, 1], seed=seed)).places
    taken = np.zeros((15, 15, 15), dtype=int)
    for start, size in zip(p.start, p.size, strict=True):
        a, b = start, start + size
        taken[a[0]:b[0], a[1]:b[1], a[2]:b[2]] += 1
        assert start.min() >= 1 and b.max() <= 14
    assert taken.max() == 1


def test_ellipsoids_of_their_own_sizes() -> None:
    diameter = [[0.008, 0.010, 0.014], [0.012, 0.012, 0.012], [0.010, 0.006, 0.008]]
    thickness = [0.002, 0.003, 0.001]
    cube = cell_cube(values("cell", cells=3, diameter=diameter, thickness=thickness, orientation="random",
                            n=24))
    mesh = cube.mesh
    assert_conforming(mesh, 0.1)
    assert min(jacobians(mesh.X, *p).min() for p in mesh.parts.values()) > 0
    for c in range(3):
        R, centre = cube.cells[c].cell.rotation, cube.places.centres[c]
        assert np.allclose(R @ R.T, np.eye(3)) and np.linalg.det(R) == pytest.approx(1.0)
        cell, pcm = mesh.parts[f"cell_{c + 1}"][1], mesh.parts[f"pcm_{c + 1}"][1]
        semi = np.array(diameter[c]) / 2.0
        for nodes, axes in ((np.intersect1d(cell, pcm), semi),
                            (np.intersect1d(pcm, mesh.parts["ecm"][1]), semi + thickness[c])):
            y = (mesh.X[nodes] - centre) @ R / axes
            assert np.allclose((y**2).sum(axis=1), 1.0)


def test_given_centres_are_kept() -> None:
    at = [[0.021, -0.013, 0.0071], [-0.02, 0.02, -0.011]]
    cube = cell_cube(values("cell", centres=at, n=24))
    assert np.array_equal(cube.places.centres, np.array(at))
    assert len(cube.cells) == 2
    assert_conforming(cube.mesh, 0.1)


WHOLE = {"cells": 20, "block": 3, "cut_from": 0.2, "layers": [1, 1, 1], "seed": 3}


@pytest.mark.parametrize("more", [{}, {"zone": "deep", "block": 0, "diameter": 0.01, "spacing": 0.0005}])
def test_cubes_cut_from_one_have_the_same_cells(more: dict[str, Any]) -> None:
    """Every block of the larger cube that lies in the smaller one, and its elements node for node."""
    large, small = (cell_cube(values("cell", **WHOLE | more | {"edge": e, "n": n})) for e, n in ((0.2, 24), (0.15, 18)))
    alone = cell_cube(values("cell", **WHOLE | more | {"edge": 0.2, "n": 24, "cut_from": 0.0}))
    assert 0 < len(small.cells) < len(large.cells) == len(alone.cells)
    low, high = large.places.start, large.places.start + large.places.size
    inside = ((low >= 3 + 1) & (high <= 21 - 1)).all(axis=1)
    k = len(small.cells)
    assert inside.sum() == k and inside[:k].all()  # numbered from the middle on
    assert np.allclose(small.places.centres, large.places.centres[:k], atol=1e-15)
    names = [n for n in small.mesh.parts if n.startswith(("cell", "pcm"))]
    for n in names:
        a, b = (cube.mesh.X[cube.mesh.parts[n][1]] for cube in (small, large))
        assert np.allclose(a, b, atol=1e-14)
    middles = [{tuple(c) for c in np.round(cube.places.centres, 12)} for cube in (alone, large)]
    assert middles[0] == middles[1]
    assert_conforming(small.mesh, 0.15)


@pytest.mark.parametrize(("given", "words"), [
    ({"edge": 0.1, "n": 12, "cut_from": 0.21}, r"whole number of elements.* more on each side; 0.216667 is"),
    ({"edge": 0.1, "n": 12, "cut_from": 0.05}, "0.1 is"),
    ({"edge": 0.1, "n": 13, "cut_from": 0.2, "cells": 1, "layers": [1, 1, 1]}, "0.207692 is|0.192308 is"),
    ({"edge": 0.05, "n": 6, "cut_from": 0.2, "block": 3, "cells": 1}, "none of the 1 cells.*another seed"),
    ({"centres": [[0.049, 0, 0]]}, "does not fit"),
    ({"centres": [[0, 0, 0], [0.012, 0, 0]]}, "overlaps"),
    ({"cells": 200, "n": 12}, "no room"),
    ({"block": 3}, "too small"),
    ({"diameter": [0.01, 0.02]}, "11 numbers"),
    ({"orientation": "sideways"}, "aligned"),
])
def test_impossible_cells_are_refused(given: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        cell_cube(values("cell", **given))


def turned(**given: Any) -> Any:
    p = values("cell", orientation=[[0.0, 0.0, np.pi / 2.0]], **given)
    return make_chondrons(p, 1, np.random.default_rng(0))[0]


def test_rotation_vectors() -> None:
    assert np.allclose(turned().cell.rotation @ [1, 0, 0], [0, 1, 0])


def test_half_extents_of_a_turned_ellipsoid() -> None:
    chondron = turned(diameter=[[2.0, 4.0, 6.0]], thickness=0.5)
    assert np.allclose(chondron.pcm.half_extents(), [2.5, 1.5, 3.5])


# control

@pytest.mark.parametrize("given", [
    {"n": 12, "layers": [3, 2, 2], "lateral": 5, "vertical": 5},
    {"n": 18, "layers": [1, 1, 1], "lateral": 3, "vertical": 7, "grading": 2.0},
    {"n": 13, "layers": [1, 1, 1], "transition": "none", "lateral": 3, "vertical": 4},
])
def test_control_holds_the_cell_mesh_node_for_node(given: dict[str, Any]) -> None:
    whole = embedded_cube(values("embedded", **given))
    cell = {k: v for k, v in given.items() if k in ("n", "layers")}
    alone = cell_cube(values("cell", **cell)).mesh
    assert np.array_equal(whole.mesh.X[:len(alone.X)], alone.X)
    for name, (_, conn) in alone.parts.items():
        assert np.array_equal(whole.mesh.parts[name][1], conn)
    assert_conforming(whole.mesh, 1.0)
    assert min(jacobians(whole.mesh.X, *p).min() for p in whole.mesh.parts.values()) > 0
    outside = whole.mesh.X[len(alone.X):]
    assert (np.abs(outside).max(axis=1) > 0.05 - 1e-12).all()


def test_control_of_the_study() -> None:
    mesh = embedded_cube(values("embedded")).mesh
    assert mesh.elements == pytest.approx(152868, rel=0.01)
    assert_conforming(mesh, 1.0)
    quality = judge(mesh.X, list(mesh.parts.values()))
    assert quality.jacobian_min > 0.5
    assert quality.scaled_jacobian_min > 0.25
    assert quality.aspect_max < 6


def test_control_lies_in_z_as_the_tissue() -> None:
    mesh = embedded_cube(values("embedded", n=12, layers=[1, 1, 1])).mesh
    edge_of_cube = np.isclose(mesh.X[:, 0], -0.5) & np.isclose(mesh.X[:, 1], -0.5)
    z = np.sort(mesh.X[edge_of_cube, 2])
    planes = tissue_planes(35, 1.0, 0.2)
    assert np.allclose(z[z > 0.1 - 1e-9], planes[planes > 0.1 - 1e-9])


def test_transition_needs_a_multiple_of_three() -> None:
    with pytest.raises(InputError, match="multiple of 3"):
        embedded_cube(values("embedded", n=13, layers=[1, 1, 1]))


def test_coarsening_layers_fill_the_shell() -> None:
    index = skin_index((9, 9, 9))
    number = np.full((10, 10, 10), -1)
    number[tuple(index.T)] = np.arange(len(index))
    skin = Skin((9, 9, 9), 0.5, number)
    layers, last = around(skin, 1.3, len(index))
    X = np.concatenate([skin.positions(), *[layer.X for layer in layers]])
    conn = np.concatenate([layer.conn for layer in layers])
    assert last.cells == (3, 3, 3)
    assert volumes(X, "hex8", conn).sum() == pytest.approx(2.6**3 - 1.0)
    quads = select(between_parts([("hex8", conn)], len(X)), np.array([0]))["quad4"]
    assert len(quads) == 6 * 81 + 6 * 9


# pieces

def test_pattern_of_a_block_that_is_no_cube() -> None:
    p = pattern((3, 4, 5), (2, 1, 2))
    quads = len(skin_quads((3, 4, 5))[0])
    assert quads == 2 * (12 + 20 + 15)
    assert len(p.cell) == 60 + 2 * quads and len(p.pcm) == quads and len(p.ecm) == 2 * quads


def test_spaced() -> None:
    x = spaced(1.0, 3.0, 5, 4.0)
    assert x[0] == 1.0 and x[-1] == 3.0
    steps = np.diff(x)
    assert steps[-1] / steps[0] == pytest.approx(4.0)
    assert np.allclose(steps[1:] / steps[:-1], steps[1] / steps[0])


def test_quality_of_known_elements() -> None:
    cube = UNIT_CUBE
    conn = np.arange(8)[None]
    assert scaled_jacobian(cube, "hex8", conn)[0] == pytest.approx(1.0)
    box = cube * [1, 2, 3]
    assert aspect(box, "hex8", conn)[0] == pytest.approx(3.0)
    assert volumes(box, "hex8", conn)[0] == pytest.approx(6.0)
    sheared = cube + np.outer(cube[:, 2], [1, 0, 0])
    assert scaled_jacobian(sheared, "hex8", conn)[0] == pytest.approx(np.sqrt(0.5))
    turned = cube[[4, 5, 6, 7, 0, 1, 2, 3]]
    assert scaled_jacobian(turned, "hex8", conn)[0] == pytest.approx(-1.0)
    assert judge(turned, [("hex8", conn)]).jacobian_min < 0
    regular = np.array([[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]], float)
    tet = np.arange(4)[None]
    assert abs(scaled_jacobian(regular, "tet4", tet)[0]) == pytest.approx(1.0)
    assert aspect(regular, "tet4", tet)[0] == pytest.approx(1.0)
    wedge = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0.75**0.5, 0], [0, 0, 1], [1, 0, 1], [0.5, 0.75**0.5, 1]])
    assert scaled_jacobian(wedge, "penta6", np.arange(6)[None])[0] == pytest.approx(1.0)
    pyramid = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0.5**0.5]])
    assert scaled_jacobian(pyramid, "pyra5", np.arange(5)[None])[0] == pytest.approx(1.0)
    assert volumes(pyramid, "pyra5", np.arange(5)[None])[0] == pytest.approx(0.5**0.5 / 3)


def test_hex_volume_is_exact_for_a_trilinear_map() -> None:
    rng = np.random.default_rng(5)
    X = UNIT_CUBE.copy()
    X += rng.uniform(-0.1, 0.1, X.shape)
    conn = np.arange(8)[None]
    # divergence theorem over the bilinear faces: V = 1/3 sum of integrals of x . n dA
    total = 0.0
    points = np.array([-1, 1]) / np.sqrt(3)
    for face in FACETS["hex8"]:
        x = X[list(face)]
        for a in points:
            for b in points:
                N = np.array([(1 - a) * (1 - b), (1 + a) * (1 - b), (1 + a) * (1 + b), (1 - a) * (1 + b)]) / 4
                da = np.array([-(1 - b), 1 - b, 1 + b, -(1 + b)]) / 4
                db = np.array([-(1 - a), -(1 + a), 1 + a, 1 - a]) / 4
                total += float(N @ x @ np.cross(da @ x, db @ x)) / 3.0
    assert volumes(X, "hex8", conn)[0] == pytest.approx(total, rel=1e-12)


@pytest.mark.parametrize("name", ["tissue", "cell", "embedded"])
def test_full_size_in_under_ten_seconds(name: str) -> None:
    template = load(name)
    start = time.perf_counter()
    template.build(template.values())
    assert time.perf_counter() - start < 10.0
