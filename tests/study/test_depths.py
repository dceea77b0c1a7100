"""Studies of many depths and sizes: points, zones, loads of one's own, the tissue's material, one dataset."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import febkit
import febkit.solving
from febkit import feb, study, templates
from febkit import materials as mt
from febkit.model import Component, InputError, MeshData, Where
from febkit.plots import canvas
from febkit.solver.run import Listener
from febkit.study import work
from febkit.study.again import smaller_steps
from febkit.study.background import material_at, with_background
from febkit.study.config import Resources
from febkit.study.depth import Column
from febkit.study.maps import _size
from febkit.study.memory import size, solve_memory, stages
from febkit.study.report import instant
from febkit.study.store import Store
from helpers.command import FEBKIT
from helpers.forked import febkit as command

SMALL = """
methods = ["1"]
[cases.slow]
case = "B"
ramp = 10.0
[tissue]
n = 3
vertical = 5
[cell]
n = 6
cells = 1
layers = [1, 1, 1]
edge = 0.05
[points]
depth = [0.2, 0.5, 0.8]
"""
ZONES = """
[zones.top]
depth = [0.0, 0.3]
cells = 2
[zones.deep]
depth = [0.3, 1.0]
"""


def written(folder: Path, text: str) -> Path:
    (folder / "deep.toml").write_text(text)
    return folder / "deep.toml"


def plan_of(folder: Path, text: str = SMALL, *overrides: str) -> study.Plan:
    return study.make_plan(study.read(written(folder, text), overrides))


def points(folder: Path, entry: str) -> study.Study:
    return study.read(written(folder, SMALL.partition("[points]")[0] + f"[points]\n{entry}\n"))


# ---- points ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("entry", "z"), [
    ("from = [0, 0, 0.4]\nto = [0, 0, -0.4]\ncount = 3", [0.4, 0.0, -0.4]),
    ("from = [0, 0, 0.1]\nto = [0, 0, 0.7]\ncount = 3\ncoordinates = 'depth'", [0.4, 0.1, -0.2]),
    ("depth = {from = 0.0, to = 1.0, count = 5}", [0.5, 0.25, 0.0, -0.25, -0.5]),
    ("z = [0.1, 0.3]\nx = 0.2\ny = -0.1", [0.1, 0.3]),
    ("at = [[0, 0, 0.25]]\ncoordinates = 'depth'", [0.25]),
    ("file = 'deep.csv'", [0.3, 0.1]),
    ("file = 'bare.csv'\ncoordinates = 'depth'", [0.2]),
])  # fmt: skip
def test_points_along_the_depth(tmp_path, entry, z):
    (tmp_path / "deep.csv").write_text("depth,name\n0.2,1\n0.4,2\n")
    (tmp_path / "bare.csv").write_text("0,0,0.3\n")
    s = points(tmp_path, entry)
    np.testing.assert_allclose([p[2] for p in s.points], z, atol=1e-12)
    np.testing.assert_allclose(s.depths, 0.5 - np.array(z), atol=1e-12)


def test_a_grid_has_all_points_and_three_axes(tmp_path):
    s = points(tmp_path, "x = [0, 0.1]\ny = {from = -0.1, to = 0.1, count = 3}\ndepth = [0.25, 0.5]")
    assert len(s.points) == 12 and len(set(s.points)) == 12 and (0.1, -0.1, 0.25) in s.points
    assert not plan_of(tmp_path, s.file.read_text()).agreement  # loads of one's own have no control unless asked for


@pytest.mark.parametrize(("entry", "said"), [
    ("depth = [0.2, 1.2]", "depth 1.2.*outside the tissue"),
    ("z = [0.6]", r"point 1 \(0, 0, 0.6\) lies outside the tissue, which reaches from z = -0.5 to 0.5"),
    ("depth = 0.5\nx = 0.7", r"point 1 \(0.7, 0, 0.5\) lies outside the tissue of case slow"),
    ("from = [0, 0, 0.1]\ncount = 2", "to is missing"),
    ("from = [0, 0, 0.1]\nto = [0, 0, 0.2]\ncount = 0", "count of .points. must be a whole number from 1"),
    ("depth = 'all'", "depth of .points. must be a number, a list"),
    ("depth = {from = 0.1, to = 0.9}", "depth of .points. must be .*count"),
    ("at = [[0, 0, 0], [0, 0, 9]]", r"point 2 \(0, 0, 9\) lies outside the tissue, which reaches from z = -0.5 to 0.5"),
    ("at = [[2, 0, 0]]", r"point 1 \(2, 0, 0\) lies outside the tissue of case slow"),
    ("depth = {from = 0.1, to = 'x', count = 2}", "depth of .points. must be a number, a list"),
    ("depth = 0.5\ncount = 3", "count of .points. does not go with depth"),
    ("z = 0.1\ndepth = 0.5", "does not go with"),
    ("depth = [0.5, 0.7, 0.5]", r"twice: points 1 and 3 are \(0, 0, 0.5\)"),
    ("at = [[0, 0, 0]]\ncoordinates = 'polar'", "coordinates of .points. must be xyz or depth"),
])  # fmt: skip
def test_points_that_cannot_be(tmp_path, entry, said):
    with pytest.raises(InputError, match=said) as e:
        points(tmp_path, entry)
    assert "deep.toml" in str(e.value)


@pytest.mark.parametrize(("text", "said"), [
    ("", "there are no points in p.csv"),
    ("depth\n", "there are no points in p.csv"),
    ("depth (mm)\n0.1\n", "head of p.csv must name the columns z or depth.*'depth .mm.' does not"),
    ("depth;x\n0.1;0\n", "with commas between: 'depth;x' does not"),
    ("0.1\n0.2\n", "point 1 of p.csv must be three numbers, x,y,z, not '0.1'; other columns need a head"),
    ("x,depth\n0,0.1\n0,y\n", "point 2 of p.csv must be numbers, not '0, y'"),
    ("depth\n0,1\n", "point 1 of p.csv must be one number, not '0, 1'"),
    ("# of the specimen\nx,y,z\n0,0,9\n", r"point 1 \(0, 0, 9\) lies outside the tissue"),
    (None, "cannot open the points p.csv|No such file"),
])  # fmt: skip
def test_files_of_points_that_cannot_be(tmp_path, monkeypatch, text, said):
    monkeypatch.chdir(tmp_path)
    if text is not None:
        Path("p.csv").write_text(text)
    with pytest.raises(InputError, match=said):
        points(Path(), "file = 'p.csv'")


def test_a_tissue_of_ones_own_needs_points(tmp_path):
    """(0, 0, 0), which the published study means, is the bone under cartilage."""
    text = "[tissue]\ntemplate = 'cartilage'\nsize = 'small'\n[cell]\nn = 6\ncells = 1\nlayers = [1, 1, 1]\n"
    with pytest.raises(InputError, match="it is not said where the cells are"):
        study.read(written(tmp_path, text))
    assert study.read(written(tmp_path, text + "[points]\nat = [[0, 0, 0.5]]\n")).points == ((0.0, 0.0, 0.5),)


def test_depth_follows_a_surface_that_is_not_flat():
    """Top z = 1 + 0.2 x + 0.1 y, bottom z = -0.3 x; the heights are those of the planes, on edges and corners too."""
    mesh = templates.new("tissue", n=3, edge=2.0, centre=0.0, vertical=2).mesh
    x, y, z = mesh.X.T
    X = np.stack([x, y, (1 + 0.2 * x + 0.1 * y) * (z + 1) / 2 - 0.3 * x * (1 - z) / 2], axis=1)
    column = Column.of(X, [(b.type, b.conn) for b in mesh.blocks], Where(""))
    for a, b in ((0.1, 0.2), (1 / 3, 0.5), (-1.0, -1.0), (0.0, 1.0)):
        low, high = column.heights(a, b) or (0, 0)
        assert high == pytest.approx(1 + 0.2 * a + 0.1 * b) and low == pytest.approx(-0.3 * a)
    assert column.heights(1.1, 0.0) is None


# ---- zones, loads, variants ------------------------------------------------------------------------


def test_zones_have_cells_of_their_own(tmp_path):
    p = plan_of(tmp_path, SMALL + ZONES)
    builds = {s.label: s.params["values"]["cells"] for s in p.steps().values() if s.label.startswith("cell")}
    assert builds == {"cell top: build": 2, "cell deep: build": 1}
    s = p.study
    assert [z.name for k in range(3) if (z := s.zone(k))] == ["top", "deep", "deep"]
    kinds = [x.kind for x in p.steps().values()]
    assert kinds.count("solve") == 1 + 3 and kinds.count("series") == 3  # one tissue


@pytest.mark.parametrize(("text", "said"), [
    (ZONES.replace("0.3]", "0.25]"), "gap between zones top and deep, from depth 0.25 to 0.3"),
    (ZONES.replace("0.3]", "0.4]"), "zones top and deep overlap from depth 0.3 to 0.4"),
    (ZONES.replace("1.0]", "0.7]"), r"point 3 \(0, 0, -0.3\) at depth 0.8 lies in no zone"),
    (ZONES.replace("[0.0, 0.3]", "0.3"), r"\[zones.top\] needs depth = \[from, to\]"),
    (ZONES.replace("cells", "cels"), r"\[cell\] with \[zones.top\]: 'cels' is no parameter.*did you mean .cells."),
    (ZONES.replace("cells", "seed"), "seeds are those of .cell."),
])  # fmt: skip
def test_zones_that_cannot_be(tmp_path, text, said):
    with pytest.raises(InputError, match=said):
        study.read(written(tmp_path, SMALL + text))


def test_other_points_leave_what_is_done(tmp_path):
    """A finer line shares all steps of its old points; so does the same point of another study."""
    few = set(plan_of(tmp_path).steps())
    more = plan_of(tmp_path, SMALL.replace("[0.2, 0.5, 0.8]", "{from = 0.2, to = 0.8, count = 7}"))
    assert few < set(more.steps()) and len(more.metrics) == 7


def test_loads_of_ones_own(tmp_path):
    text = SMALL.replace("[cases.slow]", "[cases.fast.tissue]\nramp = 0.1\n[cases.slow]")
    p = plan_of(tmp_path, text, "cell.seed=[1, 2]")
    assert p.study.cases == ("fast", "slow") and len(p.metrics) == 12
    builds = {s.label: s.params["values"] for s in p.steps().values() if s.kind == "build"}
    assert builds["slow tissue: build"] == {"case": "B", "ramp": 10.0, "n": 3, "vertical": 5}
    assert builds["fast tissue: build"] == {"ramp": 0.1, "n": 3, "vertical": 5}
    assert len(builds) == 4  # two tissues, two seeds
    with pytest.raises(InputError, match="'rmp' is no parameter"):
        plan_of(tmp_path, SMALL.replace("ramp", "rmp"))
    with pytest.raises(InputError, match=r"\[cases.NAME\] makes one of your own"):
        plan_of(tmp_path, 'cases = ["slow"]')
    with pytest.raises(InputError, match="must be the same in all cases"):
        plan_of(tmp_path, text.replace("ramp = 0.1", "edge = 2.0"))


def test_a_tissue_of_ones_own_is_one_case(tmp_path):
    feb.write(templates.new("tissue", n=3, case="B"), tmp_path / "mine.feb")
    text = 'methods = ["1"]\n[tissue]\nfile = "mine.feb"\n' + SMALL[SMALL.index("[cell]") :]
    p = plan_of(tmp_path, text)
    assert p.study.cases == ("own",) and len(p.metrics) == 3 and not p.study.control
    with pytest.raises(InputError, match="takes no parameters: case x can only name another file, not ramp"):
        plan_of(tmp_path, text + "[cases.x]\nramp = 1\n")


def test_profiles_of_the_tissue_are_known_by_their_rows(tmp_path):
    """Not by the path of their file, which is relative to the study and may be edited."""
    (tmp_path / "E.csv").write_text("depth,E\n0,0.2\n1,0.8\n")
    text = 'methods = ["1"]\n[tissue]\ntemplate = "cartilage"\nsize = "small"\n'
    text += 'E = {file = "E.csv", rule = "monotone"}\nk0 = 1e-3\n' + SMALL[SMALL.index("[cell]") :]
    p = plan_of(tmp_path, text)
    ((tissue,),) = (t.values() for t in p.study.tissues)
    assert tissue["E"] == {"points": [[0.0, 0.2], [1.0, 0.8]], "rule": "monotone"} and tissue["k0"] == 1e-3
    build = {s.label: s.key for s in p.steps().values() if s.kind == "build"}
    (tmp_path / "E.csv").write_text("depth,E\n0,0.2\n1,0.9\n")
    again = {s.label: s.key for s in plan_of(tmp_path, text).steps().values() if s.kind == "build"}
    assert {name for name in build if build[name] != again[name]} == {"own tissue: build"}
    with pytest.raises(InputError, match=r"cannot read .*none\.csv"):
        plan_of(tmp_path, text.replace("E.csv", "none.csv"))


def test_variants_are_models_side_by_side(tmp_path):
    text = 'cases = ["A"]\n' + SMALL.partition("[cases")[0] + SMALL[SMALL.index("[tissue]") : SMALL.index("[points]")]
    two = "[variants]\nedge = [0.03, 0.06]\ncells = [1, 8]\n[variants.embedded]\nlateral = [2, 3]\n"
    p = plan_of(tmp_path, text + two)
    builds = {s.label: s.params["values"] for s in p.steps().values() if s.kind == "build"}
    assert builds["cell edge 0.06: build"]["cells"] == 8
    assert builds["A embedded edge 0.03: build"]["lateral"] == 2
    assert len(p.agreement) == 2 and study.results(p, []).sizes["variant"] == 2
    wrong = {"edge = 0.1": "must be a list", "edge = [0.1]\ncells = [1, 2]": "as long as edge",
             "seed = [1, 2]": "seeds are those", "edge = [1]\nnames = ['a', 'b']": "1 different"}  # fmt: skip
    for bad, said in wrong.items():
        with pytest.raises(InputError, match=said):
            plan_of(tmp_path, text + f"[variants]\n{bad}\n")


def test_tissues_side_by_side_share_cells_and_control(tmp_path):
    text = 'cases = ["A"]\n' + SMALL.partition("[cases")[0] + SMALL[SMALL.index("[tissue]") : SMALL.index("[points]")]
    p = plan_of(tmp_path, text + '[variants]\nnames = ["coarse", "fine"]\n[variants.tissue]\nn = [3, 5]\n')
    builds = {s.label: s.params["values"] for s in p.steps().values() if s.kind == "build"}
    assert set(builds) == {"A tissue coarse: build", "A tissue fine: build", "cell: build", "A embedded: build"}
    assert [builds[f"A tissue {v}: build"]["n"] for v in ("coarse", "fine")] == [3, 5]
    solves = [s.label for s in p.steps().values() if s.kind == "solve"]
    assert len(solves) == 1 + 2 + 2 * len(p.study.methods) and len(p.agreement) == 2 * len(p.study.methods)
    assert study.results(p, []).variant_tissue_n.values.tolist() == [3, 5]
    own = plan_of(tmp_path, text.replace("n = 3", "n = 5"))
    assert set(own.steps()) < set(p.steps())  # the same steps, whatever they are called here
    for bad, said in {
        "[variants.tissue]\nm = [3, 5]": r"\[tissue\] with \[variants.tissue\]: 'm' is no parameter",
        "[variants]\nn = [3, 5]\n[variants.tissue]\nvertical = [3]": "tissue.vertical of .* must be a list as long",
        "[variants.embedded]\nn = [3, 5]": "needs lists of parameters of .cell.",
        "[variants.tissue]\nedge = [1.0, 2.0]\n[points]\nz = [0.0, 0.1]": "must be the same in all",
    }.items():
        with pytest.raises(InputError, match=said):
            plan_of(tmp_path, text + bad + "\n")


def test_cells_in_the_table_of_sizes_are_those_that_there_are():
    """Not the template's number, which a density, a zone or a larger cube may have in its place."""
    at = xr.DataArray([[0.1, 0.2, np.nan], [0.1, np.nan, np.nan], [0.3, 0.2, np.nan]], dims=("cell", "seed"))
    assert _size(at, 0.1) == ("2 to 3", "2000 to 3000")
    assert _size(at.isel(seed=[1]), 0.1) == ("2", "2000") and _size(at, None) == ("2 to 3", "")
    assert _size(at.isel(seed=[2]), 0.1) == ("", "")


@pytest.mark.parametrize(("times", "ramp", "said", "expected"), [
    ([0, 5, 10, 20], 10.0, None, 10.0),
    ([0, 5, 12, 20], 10.0, None, 12.0),  # none at the ramp's end: the first after it
    ([0, 5], 10.0, None, 5.0),
    ([0, 5, 10], 10.0, 5.0, 5.0),
])  # fmt: skip
def test_what_is_called_instantaneous(tmp_path, times, ramp, said, expected):
    entry = "" if said is None else f"instantaneous = {said}\n"
    p = plan_of(tmp_path, entry + SMALL.replace("ramp = 10.0", f"ramp = {ramp}"))
    assert instant(p, xr.Dataset(coords={"time": np.array(times, float)})) == expected


def test_an_instantaneous_time_that_no_result_has(tmp_path):
    p = plan_of(tmp_path, "instantaneous = 3\n" + SMALL)
    with pytest.raises(InputError, match=r"deep\.toml: instantaneous = 3, when no result has a state; they have 0, 5"):
        instant(p, xr.Dataset(coords={"time": np.array([0.0, 5.0])}))


# ---- the tissue's own material ---------------------------------------------------------------------


def layered() -> febkit.model.Model:
    """E by an element map (its element's number over 100), permeability by a formula of Z, fibers' axes by element."""
    m = templates.new("tissue", n=2, centre=0.0, case="B")
    block = m.mesh.blocks[0]
    n = np.arange(1, len(block.ids) + 1)
    data = [
        MeshData("element", "E_map", block.name, Component("ElementData", None, "E_map"), n, n[:, None] / 100),
        MeshData("element", "mat_axis", block.name, Component("ElementData", "mat_axis"), n,
                 np.tile([0.0, 0, 1, 1, 0, 0], (len(n), 1))),
    ]  # fmt: skip

    def changed(c: Component) -> Component:
        if c.tag == "E":
            return replace(c, type="map", text="E_map")
        if c.tag == "perm":
            return replace(c, type="math", text="0.001*(2+Z)")
        return replace(c, children=tuple(changed(x) for x in c.children))

    return replace(m, materials=tuple(changed(x) for x in m.materials), mesh_data=tuple(data), document=None)


def test_the_tissues_material_is_that_of_the_point(tmp_path):
    tissue = layered()
    feb.write(tissue, tmp_path / "t.feb")
    tissue = feb.read(tmp_path / "t.feb")
    at = (0.2, -0.2, 0.3)
    block = tissue.mesh.blocks[0]
    centres = tissue.mesh.X[block.conn].mean(axis=1)
    nearest = int(np.abs(centres - at).sum(axis=1).argmin())
    found, part = material_at(tissue, at)
    assert part == "tissue" and found.need("solid").float("E") == (nearest + 1) / 100
    assert found.need("permeability").float("perm") == pytest.approx(0.0023)
    axes = found.need("mat_axis")
    assert axes.need("a").as_floats(3) == (0, 0, 1) and axes.need("d").as_floats(3) == (1, 0, 0)
    cell = templates.new("cell", n=6, cells=1, layers=[1, 1, 1], drive="none", edge=0.05)
    model, said = with_background(cell, tissue, at, "ecm")
    feb.write(model, tmp_path / "c.feb")
    again = feb.read(tmp_path / "c.feb")
    ecm = next(m for m in again.materials if m.name == "ecm")
    assert ecm.id == 1 and ecm.need("solid").float("E") == (nearest + 1) / 100 and "E = 0.0" in said[0]
    assert [m.name for m in again.materials] == ["ecm", "pcm", "chondrocyte"]
    assert not [f for f in feb.validate(tmp_path / "c.feb") if f.severity == "error"]


@pytest.mark.parametrize(("change", "said"), [
    ({"name": "matrix"}, "no material 'matrix' to be the tissue's; it has ecm, pcm, chondrocyte"),
    ({"at": (0.9, 0, 0)}, "lies outside the tissue"),
    ({"module": "solid"}, "cannot share a material"),
    ({"lc": "1"}, "follows a load curve"),
])  # fmt: skip
def test_surroundings_that_cannot_be_taken_over(change, said):
    tissue, cell = layered(), templates.new("cell", n=6, cells=1, layers=[1, 1, 1], edge=0.05)
    if "lc" in change:
        m = tissue.materials[0]
        phi0 = Component("phi0", text="0.2", attrs={"lc": "1"})
        tissue = replace(tissue, materials=(replace(m, children=(phi0, *m.children[1:])), *tissue.materials[1:]))
    cell = replace(cell, module=change.get("module", cell.module))
    with pytest.raises(InputError, match=said):
        with_background(cell, tissue, change.get("at", (0, 0, 0)), change.get("name", "ecm"))


# ---- one dataset -----------------------------------------------------------------------------------


@pytest.fixture
def measured(tmp_path, monkeypatch) -> study.Plan:
    """A study of three depths, two seeds, whose steps only write numbers that tell their place; one is missing."""
    p = plan_of(tmp_path, SMALL + ZONES, "cell.seed=[1, 2]", "run.keep=metrics")
    number = {step.key: k for k, step in enumerate(p.metrics.values())}

    def measure(job: work.Job) -> None:
        k = number[job.folder.name.partition("-")[0]]
        cells = ["cell_1", "cell_2"] if k % 3 == 0 else ["cell_1"]  # the first point is in the upper zone
        if k == 5:
            raise work.SolveFailed("element 7 turned inside out")
        v = np.full((len(cells), 3), float(k)) + np.arange(3) / 10
        data = {"effective_strain": (("cell", "time"), v), "error": ("time", [0.0, 0.1, 0.2])}
        xr.Dataset(data, {"cell": cells, "time": [0.0, 1.0, 10.0]}).to_netcdf(job.folder / work.METRICS)

    monkeypatch.setattr(work, "KINDS", {k: lambda job: None for k in work.KINDS} | {"measure": measure})
    assert len(study.carry_out(p, "serial").failed) == 1
    return p


def test_results_are_written_place_by_place(measured, tmp_path, monkeypatch):
    """The file equals the dataset in memory, also where fewer results are held than there are."""
    monkeypatch.setattr("febkit.study.gather.BLOCK", 2)
    done = command("study", "gather", measured.study.file, "--set", "cell.seed=[1, 2]", "-o", "m.nc", folder=tmp_path)
    assert done.returncode == 0 and "5 of 6 results" in done.stdout, done.stderr
    with xr.open_dataset(tmp_path / "m.nc") as ds:
        xr.testing.assert_identical(ds.load(), study.results(measured).assign_attrs(ds.attrs))
        assert ds["effective_strain"].dims == ("case", "handoff", "point", "seed", "cell", "time")
        assert ds["error"].dims == ("case", "handoff", "point", "seed", "time")
        one = ds["effective_strain"].sel(case="slow", handoff="1", time=10.0)
        assert one.isel(point=1, seed=0, cell=0).item() == pytest.approx(1.2)
        assert np.isnan(one.isel(point=1, seed=0, cell=1)) and np.isnan(one.isel(point=2, seed=1)).all()
        assert ds["zone"].values.tolist() == ["top", "deep", "deep"]
        np.testing.assert_allclose(ds["depth"], [0.2, 0.5, 0.8])
        np.testing.assert_allclose(ds["z"], [0.3, 0.0, -0.3])


def test_maps_over_depth(measured, tmp_path):
    pytest.importorskip("matplotlib")
    files = {f.name for f in study.write_report(measured, tmp_path / "report")}
    assert {"metrics.nc", "depth_profiles_slow_1.png", "depth_map_slow_1.png", "report.md"} <= files
    text = (tmp_path / "report" / "report.md").read_text()
    assert "zones by depth: top 0 to 0.3, deep 0.3 to 1" in text and "element 7 turned inside out" in text
    row = next(r for r in text.splitlines() if r.startswith("| 0.500 |"))
    assert row.split("|")[3:5] == [" deep ", " 2.7 [1.2, 4.2] "]  # of the two seeds


def test_a_report_that_cannot_draw_says_so_before_it_writes(measured, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    monkeypatch.setattr(canvas, "_class", canvas._class.__wrapped__)
    with pytest.raises(InputError, match="figures need matplotlib: pip install"):
        list(study.write_report(measured, tmp_path / "report"))
    assert not (tmp_path / "report").exists()
    files = [p.name for p in study.write_report(measured, tmp_path / "report", figures=False)]
    assert files == ["metrics.nc", "report.md"]


# ---- solves ----------------------------------------------------------------------------------------


def pressed(folder: Path) -> Path:
    """A model as the store has it: 2 steps to t = 1, must points at 0.5 and 1."""
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("b", (1, 1, 1), (1, 1, 1))
    m.materials["s"] = mt.NeoHookean(E=1.0, v=0.3)
    m.fix(m.nodes(z=0), "x", "y", "z")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=-0.1, curve=[(0, 0), (1, 1)], name="down")
    m.step(time=1, dt=0.5, must_points=[0.5, 1.0])
    m.write(folder / work.MODEL)
    return folder


def solved(folder: Path, inputs: Path, tried: work.Try) -> dict:
    folder.mkdir()
    job = work.Job(folder, {}, {"model": inputs}, {}, {}, tried)
    work.solve(job)
    return job.record


def test_a_solve_that_fails_is_tried_once_more_with_smaller_steps(tmp_path, monkeypatch):
    model = pressed(tmp_path)
    once = solved(tmp_path / "once", model, work.Try(retry=True))
    assert once["steps"] == 2 and "retried" not in once
    real, tries = work._solved, []

    def fails_at_first(job, m, said, every=""):
        tries.append(m)
        result = real(job, m, said)
        if len(tries) in failing:
            result.converged, result.reason = False, f"element {len(tries)} turned inside out"
        return result

    monkeypatch.setattr(work, "_solved", fails_at_first)
    failing = {1}
    record = solved(tmp_path / "twice", model, work.Try(retry=True))
    assert record["steps"] == 8 and "a quarter" in record["retried"]
    assert record["before"] == "element 1 turned inside out"
    with febkit.open_results(tmp_path / "once" / work.RESULTS) as a, febkit.open_results(
        tmp_path / "twice" / work.RESULTS
    ) as b:
        assert set(a["time"].values) <= set(b["time"].values)  # must points are kept
        np.testing.assert_allclose(a["displacement"][-1], b["displacement"][-1], atol=1e-6)  # and the load
    failing, tries = {1, 2}, []
    with pytest.raises(work.SolveFailed, match=r"element 1 turned inside out; at a second try, .*: element 2"):
        solved(tmp_path / "never", model, work.Try(retry=True))
    failing, tries = {1}, []
    with pytest.raises(work.SolveFailed, match=r"^element 1 turned inside out$"):
        solved(tmp_path / "no", model, work.Try())


def test_an_interrupted_solve_is_not_tried_once_more(tmp_path, monkeypatch):
    """Ctrl-C within a solve ends it with what it has; the study ends there, rather than try smaller steps."""
    real, tries = febkit.solving.solve, []

    class CtrlC(Listener):
        def iteration(self, run, it):
            raise KeyboardInterrupt

    def interrupted(*args, **more):
        tries.append(args)
        return real(*args, **more | {"listeners": [CtrlC()]})

    monkeypatch.setattr("febkit.solving.solve", interrupted)
    with pytest.raises(KeyboardInterrupt):
        solved(tmp_path / "once", pressed(tmp_path), work.Try(retry=True))
    assert len(tries) == 1


def test_smaller_steps_leave_what_else_follows_the_curve():
    m = templates.new("tissue", n=3)
    small = smaller_steps(m)
    before, after = m.steps[0].control, small.steps[0].control
    assert after.float("step_size") * after.int("time_steps") == before.float("step_size") * before.int("time_steps")
    stepper = after.need("time_stepper")
    assert stepper.int("max_retries") == 2 * before.need("time_stepper").int("max_retries")
    curves = {c.id: c.points for c in small.controllers}
    old, new = (curves[c.need("time_stepper").need("dtmax").lc] for c in (before, after))
    assert new == tuple((t, v / 4) for t, v in old) and set(curves) > {c.id for c in m.controllers}


def test_a_solve_may_take_so_long_and_no_longer(tmp_path):
    with pytest.raises(work.SolveFailed, match=r"given up after 1e-09 s \(limit of \[run\]\), at time"):
        solved(tmp_path / "run", pressed(tmp_path), work.Try(1e-9, True))


def test_estimates_grow_with_the_model_and_the_users_number_wins(tmp_path, monkeypatch):
    monkeypatch.setattr("febkit.study.memory.free_memory", lambda: 30.0)
    monkeypatch.setattr("febkit.study.memory.cores", lambda: 4)
    assert solve_memory(0) < solve_memory(10_000) < solve_memory(100_000) < 64
    p = plan_of(tmp_path)
    store = Store(p.study.folder)
    large = {"tissue": 200_000}

    def plan(r: Resources) -> list:
        out = []
        for s in stages(p.steps(), store, r):
            for key, step in s.steps.items():
                if step.kind == "build":
                    with store.making(key, {}) as (_, record):
                        record["unknowns"] = large["tissue" if "tissue" in step.label else "cell"]
            out.append(s)
        return out

    large["cell"] = 3_000
    first, tissue, cells = plan(Resources(0, 0.0))
    assert first.serial and {s.kind for s in first.steps.values()} == {"build"}
    assert tissue.unknowns == 200_000 and tissue.resources.memory >= solve_memory(200_000)
    assert tissue.resources.workers * tissue.resources.memory <= 30.0 and tissue.resources.threads > 1
    assert cells.unknowns == 3_000 and (cells.resources.workers, cells.resources.threads) == (3, 1)
    assert sum(len(s.steps) for s in (first, tissue, cells)) == len(p.steps())
    (one,) = plan(Resources(2, 3.0))
    assert (one.resources.threads, one.resources.memory) == (2, 3.0) and len(one.steps) == len(p.steps())
    assert [s.resources.workers for s in plan(Resources(0, 0.0, 2))][-1] == 2
    assert size(templates.new("tissue", n=3)) == 4 * 64


def test_what_is_gathered_goes_onto_no_input(tmp_path):
    """Neither onto the study, whatever it is called, nor onto results that it takes."""
    file, kept = written(tmp_path, SMALL), (tmp_path / "deep.toml").read_bytes()
    done = command("study", "gather", file, "-o", "deep.toml", folder=tmp_path)
    assert done.returncode == 2 and "ends in .nc" in done.stderr and file.read_bytes() == kept
    file = file.rename(tmp_path / "deep.nc")
    done = command("study", "gather", file, "-o", "deep.nc", folder=tmp_path)
    assert done.returncode == 2 and "deep.nc" in done.stderr and file.read_bytes() == kept
    done = command("study", "gather", file, "-o", "other.nc", folder=tmp_path)
    assert done.returncode == 2 and "nothing of the study" in done.stderr and not (tmp_path / "other.nc").exists()


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="Ctrl-C goes to a group of processes on POSIX")
def test_ctrl_c_ends_all_workers_without_a_word_of_theirs(tmp_path):
    """A terminal sends it to the workers too. No other test interrupts a cluster, which takes seconds to begin."""
    written(tmp_path, SMALL + "[run]\nmemory = 1\n")  # one stage, by workers
    job = subprocess.Popen([FEBKIT, "study", "run", "deep.toml"], cwd=tmp_path, stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE, text=True, start_new_session=True)  # fmt: skip
    first = job.stdout.readline()
    os.killpg(job.pid, signal.SIGINT)
    _, said = job.communicate(timeout=60)
    assert first.startswith("[1/") and job.returncode == 130 and said.strip() == "interrupted"
    done = command("study", "status", "deep.toml", folder=tmp_path)
    assert done.returncode == 0 and "build" in done.stdout
    with pytest.raises(ProcessLookupError):  # none is left, at the latest a moment after
        for _ in range(200):
            os.killpg(job.pid, 0)
            time.sleep(0.1)
