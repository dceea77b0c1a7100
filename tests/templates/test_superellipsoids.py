"""Superellipsoidal cells in eccentric PCM: exact surfaces and volumes, meshes that carry homogeneous deformation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import dblquad

import febkit
from febkit.feb import write
from febkit.model import InputError, Where
from febkit.templates import new
from febkit.templates.cell_cube import CellCube, cell_cube, volume_report
from febkit.templates.cells import make_chondrons
from febkit.templates.quality import judge, volumes
from febkit.templates.superellipsoids import Superellipsoid, directions, reach
from febkit.templates.template import load
from helpers.forked import febkit as verb

FLAT = {"cells": 1, "diameter": [[0.012, 0.006, 0.004]], "thickness": [[0.000976, 0.000976, 0.000918]],
        "squareness": 2.3, "centres": [[0.0, 0.0, 0.0]]}  # fmt: skip


def values(**given: Any) -> dict[str, Any]:
    return load("cell").values([(given, Where())])


def body(axes: list[float], n: list[float], turn: np.ndarray | None = None) -> Superellipsoid:
    return Superellipsoid(np.array(axes), np.array(n), np.eye(3) if turn is None else turn, np.array([0.3, 0.0, -1.0]))


def a_turn(seed: int) -> np.ndarray:
    p = {"diameter": 1.0, "thickness": 1.0, "squareness": 2.0, "pcm_squareness": 0.0, "shift": 0.0,
         "group": 1, "column": "z", "spacing": 0.1, "seed": 0}  # fmt: skip
    return make_chondrons(p | {"orientation": "random"}, 1, np.random.default_rng(seed))[0].cell.rotation


@pytest.mark.parametrize("n", [[2.0, 2.0, 2.0], [2.3, 2.3, 2.3], [1.2, 3.0, 8.0]])
def test_volume_is_the_integral(n: list[float]) -> None:
    a, b, c = 6.0, 3.0, 2.0

    def height(y: float, x: float) -> float:
        return float(max(0.0, 1.0 - x ** n[0] - y ** n[1]) ** (1.0 / n[2]))

    octant, _ = dblquad(height, 0.0, 1.0, 0.0, lambda x: (1.0 - x ** n[0]) ** (1.0 / n[1]), epsabs=1e-6)
    assert body([a, b, c], n).volume == pytest.approx(8 * a * b * c * octant, rel=1e-4)


def test_volume_of_an_octahedron_a_sphere_and_nearly_a_box() -> None:
    assert body([2, 3, 4], [1, 1, 1]).volume == pytest.approx(4 / 3 * 2 * 3 * 4)
    assert body([2, 2, 2], [2, 2, 2]).volume == pytest.approx(4 / 3 * np.pi * 8)
    assert body([2, 3, 4], [1e4, 1e4, 1e4]).volume == pytest.approx(8 * 2 * 3 * 4, rel=1e-6)


@pytest.mark.parametrize("n", [[2.3, 2.3, 2.3], [1.0, 1.0, 1.0], [1.2, 3.0, 8.0], [50.0, 50.0, 50.0]])
def test_surface_points_satisfy_the_equation(n: list[float]) -> None:
    turn = a_turn(3)
    b = body([6.0, 3.0, 2.0], n, turn)
    x = b.surface(directions(500))
    y = (x - b.centre) @ turn / b.semi_axes
    assert np.allclose((np.abs(y) ** np.array(n)).sum(axis=1), 1.0, rtol=1e-12)
    assert np.allclose(b.gauge(x), 1.0, rtol=1e-13)
    half = np.abs(x - b.centre).max(axis=0)
    assert (half <= b.half_extents() * (1 + 1e-12)).all()
    if len(set(n)) == 1:
        many = np.abs(b.surface(directions(100_000)) - b.centre).max(axis=0)
        assert np.allclose(b.half_extents(), many, rtol=0.02)


def test_an_ellipsoid_is_the_stretched_sphere() -> None:
    turn = a_turn(1)
    n = directions(100)
    b = Superellipsoid(np.array([6.0, 3.0, 2.0]), np.full(3, 2.0), turn, np.zeros(3))
    assert np.array_equal(b.surface(n), n @ ((turn * b.semi_axes) @ turn.T))
    assert np.array_equal(reach(np.zeros((1, 3)), np.full(3, 2.3)), [1.0])


def on(cube: CellCube, part: str, other: str) -> np.ndarray:
    """Nodes (node, 3) between two parts of the only cell's block."""
    return cube.mesh.X[np.intersect1d(cube.mesh.parts[part][1], cube.mesh.parts[other][1])]


def test_cells_of_all_kinds_in_one_cube() -> None:
    given = {"cells": 3, "diameter": [[0.012, 0.006, 0.004], [0.01, 0.01, 0.01], [0.006, 0.008, 0.012]],
             "thickness": [[0.001, 0.0012, 0.0009], [0.0025] * 3, [0.002] * 3], "squareness": [2.3, 2.0, 4.0],
             "pcm_squareness": [2.3, 2.5, 3.0], "shift": [[0, 0, 0.0002], [0.001, 0, 0], [0.0005, -0.0004, 0.0006]],
             "orientation": "random", "n": 24, "layers": [2, 2, 2]}  # fmt: skip
    cube = cell_cube(values(**given))
    assert judge(cube.mesh.X, list(cube.mesh.parts.values())).jacobian_min > 0.4
    total = sum(volumes(cube.mesh.X, *p).sum() for p in cube.mesh.parts.values())
    assert total == pytest.approx(1e-3, rel=1e-12)
    for c, chondron in enumerate(cube.cells):
        at = cube.places.centres[c]
        assert np.allclose(chondron.cell.gauge(on(cube, f"cell_{c + 1}", f"pcm_{c + 1}") - at), 1.0, rtol=1e-9)
        assert np.allclose(chondron.pcm.gauge(on(cube, f"pcm_{c + 1}", "ecm") - at), 1.0, rtol=1e-9)


def test_volumes_of_cell_and_eccentric_pcm_are_of_second_order() -> None:
    missing = []
    for block, n in ((8, 30), (16, 60)):
        cube = cell_cube(values(**FLAT, n=n, block=block, shift=0.0004, layers=[1, 1, 1]))
        v = volume_report(cube.mesh, cube.cells, 1e-3)
        missing.append([1.0 - v[f"{part} volume fraction"] / v[f"exact {part} volume fraction"]
                        for part in ("cell", "PCM")])
    assert np.allclose(np.log2(np.array(missing[0]) / missing[1]), 2.0, atol=0.15)
    assert max(missing[1]) < 0.02


def test_a_shift_moves_the_cell_and_nothing_else() -> None:
    still, moved = (cell_cube(values(**FLAT, n=24, shift=s)) for s in (0.0, 0.0002))
    assert np.allclose(on(moved, "cell_1", "pcm_1") - on(still, "cell_1", "pcm_1"), [0, 0, 0.0002], rtol=0, atol=1e-15)
    assert np.array_equal(on(moved, "pcm_1", "ecm"), on(still, "pcm_1", "ecm"))
    report = volume_report(moved.mesh, moved.cells, 1e-3)
    assert report["thinnest PCM"] == pytest.approx(0.000718, rel=1e-6)  # 0.918 less 0.2 um, at the cell's top


@pytest.mark.parametrize(("given", "words"), [
    ({"shift": 0.00095}, "PCM of cell 1 does not enclose it"),
    ({"shift": 0.1}, "PCM of cell 1 does not enclose it"),
    ({"squareness": 6.0, "pcm_squareness": 2.0}, "PCM of cell 1 does not enclose it"),
    ({"squareness": 0.5}, "at least 1"), ({"squareness": 51}, "at most 50"),
    ({"pcm_squareness": 0.5}, "between 1 and 50"),
    ({"thickness": [[0.001, 0.001]]}, "thickness must be one number, 1 numbers or 1 triples"),
    ({"shift": [[0.0, 1.0], 2.0]}, "shift must be one number"),
    ({"diameter": 0.004, "thickness": [[0.012, 0.001, 0.001]], "shift": [[0.0108, 0, 0]],
      "pcm_squareness": 6.0}, "inside out, in pcm_1"),
])  # fmt: skip
def test_what_cannot_be_is_refused(given: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        load("cell").build(values(**{**FLAT, "n": 24, **given}))


def test_the_verb_reports_thickness_and_quality(tmp_path: Path) -> None:
    (tmp_path / "flat.toml").write_text("\n".join(f"{k} = {v}" for k, v in FLAT.items()) + "\nshift = 0.0002\nn = 12\n")
    made = verb("new", "cell", "--params", "flat.toml", "-o", "flat.feb", folder=tmp_path)
    assert made.returncode == 0 and (tmp_path / "flat.feb").is_file()
    assert "thinnest PCM: 0.00072" in made.stdout and "smallest Jacobian" in made.stdout
    wrong = verb("new", "cell", "--params", "flat.toml", "--set", "shift=0.001", "-o", "no.feb", folder=tmp_path)
    assert wrong.returncode == 2 and "PCM of cell 1" in wrong.stderr and not (tmp_path / "no.feb").exists()


def test_materials_and_membranes_of_cells_in_a_cube() -> None:
    ecm = {"type": "Holmes-Mow", "E": "${2*cell_E}", "v": 0.2, "beta": 1.0}
    model = new("cell", size="small", cells=2, ecm=ecm, membrane_thickness=1e-5)
    assert [m.name for m in model.materials] == ["ecm", "pcm", "chondrocyte", "membrane"]
    assert model.materials[0].need("solid").float("E") == 0.002 and model.materials[0].float("phi0") == 0.2
    assert model.materials[1].need("solid").type == "neo-Hookean"
    shells = {d.block: d.material for d in model.domains if d.kind == "shell"}
    assert shells == {"membrane_1": "membrane", "membrane_2": "membrane"}
    with pytest.raises(InputError, match="biphasic"):
        new("cell", size="small", membrane_thickness=1e-5, physics="triphasic")


def test_homogeneous_shear_is_exact_through_all_parts(tmp_path: Path) -> None:
    """A patch test through the hand-off: of one material, u = (F - 1) X and p = 0 where F keeps volume."""
    stuff = {f"{part}_{q}": v for part in ("ecm", "pcm", "cell") for q, v in (("E", 0.5), ("v", 0.2), ("k", 2e-3))}
    model = new("cell", **FLAT, **stuff, n=8, edge=0.04, block=4, layers=[1, 1, 1], shift=0.0002, times=[0, 1], ramp=1,
                orientation=[[0.2, 0.3, 0.1]], dtol=1e-9, etol=1e-18, ptol=1e-9, updates=0, first_step=1.0,
                longest_step=1.0, ramp_step=1.0)  # fmt: skip
    write(model, tmp_path / "cell.feb")
    (tmp_path / "shear.csv").write_text("t,Fxy,Fxz,Fyz,p\n0,0,0,0,0\n1,0.1,0.2,0.05,0\n")
    made = verb("boundary", "shear.csv", "cell.feb", "--order", "1", "-o", "driven.feb", folder=tmp_path)
    assert made.returncode == 0, made.stderr
    state = febkit.read(tmp_path / "driven.feb").solve().dataset.isel(time=-1)
    more = np.array([[0, 0.1, 0.2], [0, 0, 0.05], [0, 0, 0]])
    assert np.allclose(state["displacement"], model.mesh.X @ more.T, rtol=0, atol=1e-9)  # plotfiles hold single floats
    E = (more + more.T + more.T @ more) / 2.0
    assert np.allclose(state["Lagrange_strain"], E[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]], rtol=0, atol=1e-8)
    assert np.allclose(state["effective_fluid_pressure"], 0.0, atol=1e-9)
