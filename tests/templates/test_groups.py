"""Chondrons of several cells in rows, and the cells of the zones of cartilage."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit.feb import write
from febkit.metrics import cell_metrics
from febkit.model import InputError, Where
from febkit.templates import new
from febkit.templates.cell_cube import CellCube, cell_cube
from febkit.templates.chondron_block import chondron_block
from febkit.templates.embedded_cube import embedded_cube
from febkit.templates.quality import judge, volumes
from febkit.templates.template import load
from helpers.forked import febkit as verb

ROW = {"cells": 1, "centres": [[0.0, 0.0, 0.0]], "n": 24, "edge": 0.12, "layers": [2, 2, 2]}


def values(name: str, **given: Any) -> dict[str, Any]:
    return load(name).values([(given, Where())])


def total(mesh: Any) -> float:
    return float(sum(volumes(mesh.X, *p).sum() for p in mesh.parts.values()))


def shared(cube: CellCube, a: str, b: str) -> np.ndarray:
    return cube.mesh.X[np.intersect1d(cube.mesh.parts[a][1], cube.mesh.parts[b][1])]


@pytest.mark.parametrize(("several", "column", "more"), [
    (2, "z", {}), (3, "x", {"squareness": 2.3}), (4, "y", {"diameter": [[0.012, 0.008, 0.01]]}),
])  # fmt: skip
def test_rows_of_cells_in_one_pcm(several: int, column: str, more: dict[str, Any]) -> None:
    cube = cell_cube(values("cell", **ROW, group=several, column=column, **more))
    mesh, (row,) = cube.mesh, cube.cells
    assert list(mesh.parts) == ["ecm", "pcm_1", *(f"cell_{i + 1}" for i in range(several))]
    quality = judge(mesh.X, list(mesh.parts.values()))
    assert quality.jacobian_min > 0.6 and quality.scaled_jacobian_min > 0.25
    assert total(mesh) == pytest.approx(0.12**3, rel=1e-12)
    assert len(np.unique(np.round(mesh.X / 0.12, 10), axis=0)) == len(mesh.X)
    for i, cell in enumerate(row.cells):
        assert np.allclose(cell.gauge(shared(cube, f"cell_{i + 1}", "pcm_1")), 1.0, rtol=1e-9)
        beside = cell.centre["xyz".index(column)]
        assert beside == pytest.approx((i - (several - 1) / 2) * (2 * cell.semi_axes["xyz".index(column)] + 0.001))
    assert np.allclose(row.pcm.gauge(shared(cube, "pcm_1", "ecm")), 1.0, rtol=1e-9)


def test_volumes_of_a_row_are_of_second_order() -> None:
    missing = []
    for divisions in (6, 12):
        made = chondron_block(values("chondron", group=2, divisions=[divisions] * 3, layers=[1, 2, 1]))
        v = made.report()
        missing.append([1.0 - total(made.mesh) / made.whole.volume,
                        *(1.0 - v[f"{p} volume fraction"] * total(made.mesh) / (v[f"exact {p} volume fraction"]
                          * made.whole.volume) for p in ("cell", "PCM"))])  # fmt: skip
    assert np.allclose(np.log2(np.array(missing[0]) / missing[1]), 2.0, atol=0.25)
    assert np.abs(missing[1]).max() < 0.02
    assert made.chondron.volumes[0] == pytest.approx(2 * made.chondron.cell.volume)


def test_surfaces_of_a_row() -> None:
    mesh = new("cell", **{**ROW, "layers": [1, 2, 1]}, group=2, membrane_thickness=1e-5).mesh
    quads = {name: len(mesh.surfaces[f"{name}_surface"].facets["quad4"]) for name in ("cell_1", "cell_2", "pcm_1")}
    blocks = {b.name: b for b in mesh.blocks}
    assert quads["cell_1"] == quads["cell_2"] == len(blocks["membrane_2"].conn)
    assert mesh.part_lists["membranes"] == ("membrane_1", "membrane_2")
    outside = np.unique(mesh.surfaces["pcm_1_surface"].facets["quad4"])
    assert np.isin(outside, blocks["ecm"].conn).all() and not np.isin(outside, blocks["cell_1"].conn).any()


def test_single_cells_and_rows_side_by_side_in_the_control() -> None:
    given = {"cells": 3, "group": [1, 2, 3], "column": ["z", "x", "y"], "n": 24, "layers": [2, 2, 2], "lateral": 3,
             "vertical": 4}  # fmt: skip
    whole = embedded_cube(values("embedded", **given))
    assert len(whole.inner.cells) == 3 and "cell_6" in whole.mesh.parts and "cell_7" not in whole.mesh.parts
    assert judge(whole.mesh.X, list(whole.mesh.parts.values())).jacobian_min > 0.4
    assert total(whole.mesh) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(("given", "words"), [
    ({"group": 2, "shift": 0.0001}, "several cells"), ({"group": 2, "orientation": "random"}, "several cells"),
    ({"group": [1, 2]}, "group must be one whole number"), ({"group": 2.5}, "group must be one whole number"),
    ({"group": 2, "column": "w"}, "column must be x, y, z or random"),
    ({"group": 4, "thickness": 0.0005}, "PCM"),
    ({"group": 3, "block": 3, "centres": []}, "too small"),
    ({"density": 9000, "shares": [], "centres": []}, "shares must be"),
])  # fmt: skip
def test_what_cannot_be_is_refused(given: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        new("cell", **{**ROW, **given})


@pytest.mark.parametrize(("zone", "cells"), [("superficial", 17), ("transitional", 10), ("deep", 6)])
def test_zones_have_their_density(zone: str, cells: int) -> None:
    small = {"zone": zone, "n": 24, "layers": [1, 1, 1]}
    one, same, other = (cell_cube(values("cell", **small, seed=s)) for s in (4, 4, 5))
    assert sum(len(c.cells) for c in one.cells) == cells
    assert np.array_equal(one.mesh.X, same.mesh.X) and not np.array_equal(one.mesh.X[-1], other.mesh.X[-1])
    rows = [len(c.cells) for c in one.cells]
    assert len({c.column for c in one.cells}) > 1 if zone == "transitional" else one.cells[0].column == 2
    assert max(rows) == 1 if zone == "superficial" else max(rows) > 1
    flat = one.cells[0].cell
    if zone == "superficial":
        assert np.allclose(flat.rotation[2], [0, 0, 1]) and flat.semi_axes[2] == 0.002
    assert cell_cube(values("cell", **small, density=0.0, cells=2)).cells[0].cell.semi_axes[0] == flat.semi_axes[0]


def test_zones_hold_the_mean_density() -> None:
    brought = load("cell").brought["zone"]
    mean = sum(share * brought[zone]["density"] for zone, share in
               (("superficial", 0.15), ("transitional", 0.55), ("deep", 0.30)))
    assert mean == pytest.approx(9626, rel=0.005)  # cells/mm^3, Hunziker, Quinn & Haeuselmann 2002
    assert brought["superficial"]["density"] == pytest.approx(3 * brought["deep"]["density"], rel=0.01)


def test_homogeneous_shear_is_exact_through_a_row(tmp_path: Path) -> None:
    stuff = {f"{part}_{q}": v for part in ("ecm", "pcm", "cell") for q, v in (("E", 0.5), ("v", 0.2), ("k", 2e-3))}
    model = new("cell", **{**ROW, "n": 8, "edge": 0.05, "layers": [1, 2, 1], "margin": 0, "room": 1.1}, **stuff,
                group=2, times=[0, 1], ramp=1, dtol=1e-12, etol=0, ptol=0, updates=0, min_residual=0,
                first_step=1.0, longest_step=1.0, ramp_step=1.0)  # fmt: skip
    write(model, tmp_path / "row.feb")
    (tmp_path / "shear.csv").write_text("t,Fxy,Fxz,Fyz,p\n0,0,0,0,0\n1,0.1,0.2,0.05,0\n")
    made = verb("boundary", "shear.csv", "row.feb", "--order", "1", "-o", "driven.feb", folder=tmp_path)
    assert made.returncode == 0, made.stderr
    m = febkit.read(tmp_path / "driven.feb")
    last = m.solve().dataset.isel(time=-1)
    more = np.array([[0, 0.1, 0.2], [0, 0, 0.05], [0, 0, 0]])
    assert np.allclose(last["displacement"], model.mesh.X @ more.T, rtol=0, atol=1e-9)
    assert list(cell_metrics(last.expand_dims("time"), m)["cell"].values) == ["cell_1", "cell_2"]
