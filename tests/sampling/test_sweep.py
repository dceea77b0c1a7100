"""Sweeps: designs, samples that fail, what is kept after a kill, Sobol indices; each against what it must equal."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import febkit
from febkit import materials as mt
from febkit.model import InputError
from febkit.sampling.content import address
from febkit.sampling.design import Range, points
from febkit.sampling.result import Swept, gathered
from febkit.sampling.runs import Found
from febkit.sampling.sweep import make_sweep
from helpers import forked
from helpers.command import FEBKIT
from helpers.command import febkit as command

E, DOWN = "fem.material('s').E", "fem.bc('down').value"
TOP = "reaction top z"


def cube() -> febkit.Model:
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("b", (1, 1, 1), (1, 1, 1))
    m.materials["s"] = mt.NeoHookean(E=1.0, v=0.3)
    m.fix(m.nodes(z=0), "x", "y", "z")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=-0.1, curve=[(0, 0), (1, 1)], name="down")
    m.step(time=1, dt=0.5, fixed=True)
    return m


BOX = (Range("a", 0.0, 1.0), Range("b", 10.0, 30.0))


@pytest.mark.parametrize("design", ["sobol", "lhs", "random", "grid"])
def test_designs_fill_the_box(design: str) -> None:
    x = points(BOX, 64, design, 1)
    assert x.shape == (64, 2) and (x >= [0, 10]).all() and (x <= [1, 30]).all()
    assert np.array_equal(x, points(BOX, 64, design, 1))
    cells = np.histogram2d(x[:, 0], x[:, 1], bins=(8, 8), range=((0, 1), (10, 30)))[0]
    strata = np.histogram(x[:, 1], bins=64, range=(10, 30))[0]
    if design == "sobol":
        assert (cells == 1).all()
    elif design == "lhs":
        assert (strata == 1).all()
    elif design == "grid":
        assert sorted(set(x[:, 0])) == pytest.approx(np.linspace(0, 1, 8))
    if design != "grid":
        assert not np.array_equal(x, points(BOX, 64, design, 2))


def test_samples_are_the_solves_of_a_loop_and_failures_say_why() -> None:
    def width(ds: xr.Dataset) -> float:
        return float(ds.febkit.node_set("top")["displacement"].sel(xyz="x").isel(time=-1).max())

    m = cube()
    over = {E: (0.5, 2.0), DOWN: (-1.5, 0.3)}
    result = febkit.sweep(m, over, observe={"force": TOP, "width": width}, samples=9, design="grid")
    ds = result.dataset
    assert m.materials["s"].E == 1.0  # the model itself is left as it was
    assert ds["force"].dims == ("sample", "time") and ds["width"].dims == ("sample",) and ds["force"].units == "N"
    assert not result and set(result.failed) == {0, 3, 6}  # pressed through the floor
    for k in range(9):
        m[E], m[DOWN] = float(ds[E][k]), float(ds[DOWN][k])
        if k in result.failed:
            assert np.isnan(ds["force"][k]).all() and np.isnan(ds["width"][k])
            assert "turned inside out" in result.failed[k]
        else:
            alone = m.solve(threads=1).dataset
            assert np.array_equal(ds["force"][k], alone.febkit.reaction("top").sel(xyz="z"))
            assert float(ds["width"][k]) == width(alone)
    with pytest.raises(InputError, match="saltelli"):
        result.sobol()


@pytest.mark.parametrize(
    ("over", "observe", "why"),
    [
        ({E: (-1, 2)}, TOP, "more than 0"),
        ({E: (2, 1)}, TOP, "low < high"),
        ({"fem.material('s').Q": (1, 2)}, TOP, "no parameter 'Q'"),
        ({}, TOP, "varies something"),
        ({E: (1, 2)}, "reaction tp z", "'tp'"),
        ({E: (1, 2)}, "stress part b qq", "which component"),
        ({E: (1, 2)}, [], "what to observe"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_solved(over: dict, observe: object, why: str) -> None:
    with pytest.raises(InputError, match=why):
        make_sweep(cube(), over, observe)  # type: ignore[arg-type]


def test_times_after_the_end_and_paths_given_twice_are_refused(tmp_path: Path) -> None:
    m = cube()
    with pytest.raises(InputError, match="the time 50 is asked for, and the model's steps end at"):
        make_sweep(m, {E: (1, 2)}, TOP, at=[0.5, 50])
    m.write(tmp_path / "m.feb")
    for more, why in ((["--vary", f"{E}=1:3"], "a path is given twice"), (["--at", "50"], "m.feb: the time 50 is")):
        done = forked.febkit("sweep", "m.feb", "--vary", f"{E}=1:2", "--observe", TOP, *more, folder=tmp_path)
        assert done.returncode == 2 and why in done.stderr


def test_functions_do_not_travel(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a function"):
        febkit.sweep(cube(), {E: (1, 2)}, observe=lambda ds: 0.0, samples=2, folder=tmp_path)


def test_an_address_is_the_content_s(tmp_path: Path) -> None:
    m = cube()
    for name in ("a.feb", "b.feb"):
        m.write(tmp_path / name)
    a, b = (febkit.read(tmp_path / n) for n in ("a.feb", "b.feb"))
    assert address(a.record) == address(b.record)
    b.materials["s"].v = 0.2
    assert address(a.record) != address(b.record)


def test_times_that_differ_stay_with_their_samples() -> None:
    found = [
        Found(np.array([0.0, 1.0]), {"f": np.array([0.0, 5.0])}),
        Found(reason="lost"),
        Found(np.array([0.0, 0.5, 1.0]), {"f": np.array([0.0, 2.0, 4.0])}),
    ]
    ds = gathered(found, BOX[:1], np.zeros((4, 1)), {})
    assert ds["f"].dims == ds["time"].dims == ("sample", "state")
    assert ds["time"].values[2].tolist() == [0.0, 0.5, 1.0] and ds["f"].values[0, :2].tolist() == [0.0, 5.0]
    assert ds["reason"].values.tolist() == ["", "lost", "", "not run"]


def test_a_killed_sweep_goes_on_and_equals_one_that_was_not(tmp_path: Path) -> None:
    m = cube()
    m.write(tmp_path / "cube.feb")
    args = ["sweep", "cube.feb", "--vary", f"{E}=0.5:2", "--vary", f"{DOWN}=-0.3:-0.1", "--observe", TOP,
            "--samples", "80", "--scheduler", "serial"]  # fmt: skip
    job = subprocess.Popen([FEBKIT, *args], cwd=tmp_path, stdout=subprocess.DEVNULL)
    store, until = tmp_path / "cube.sweep" / "store", time.monotonic() + 120
    while len(list(store.glob("*/*/step.json"))) < 3 and time.monotonic() < until and job.poll() is None:
        time.sleep(0.02)
    job.kill()
    job.wait()
    before = {p: p.stat().st_mtime_ns for p in store.glob("*/*/step.json")}
    assert 3 <= len(before) < 40
    done = command(*args, folder=tmp_path)
    assert done.returncode == 0 and "80 solved, 0 failed" in done.stdout, done.stderr
    assert all(p.stat().st_mtime_ns == t for p, t in before.items())
    with xr.open_dataset(tmp_path / "cube.sweep" / "sweep.nc") as ds:
        whole = febkit.sweep(m, {E: (0.5, 2), DOWN: (-0.3, -0.1)}, observe=TOP, samples=80).dataset
        assert np.array_equal(ds[TOP], whole[TOP]) and np.array_equal(ds[E], whole[E])
    failing = command(*args[:2], "--vary", f"{DOWN}=-1.5:-0.1", "--observe", TOP, "--samples", "2", "--design", "grid",
                      "--scheduler", "serial", "-q", folder=tmp_path)  # fmt: skip
    assert failing.returncode == 1 and failing.stdout == "" and "sample 0 failed: element 1" in failing.stderr


def test_sobol_indices_of_a_sum() -> None:
    """Of f = 4 a + b over equal ranges a makes 16/17 of the variance, alone and in all; a constant has no indices."""
    pytest.importorskip("SALib", reason='needs pip install "febkit[sensitivity]"')
    box = (Range("a", 0.0, 1.0), Range("b", 0.0, 1.0))
    x = points(box, 256, "saltelli", 3)
    f = 4 * x[:, 0] + x[:, 1]
    found = [Found(np.array([0.0, 1.0]), {"f": np.array([0.0, v])}) for v in f]
    out = Swept(gathered(found, box, x, {}), ["a", "b"], "saltelli", 3).sobol()
    assert np.isnan(out["f"].isel(time=0)).all()
    end = out["f"].isel(time=1)
    for kind in ("first", "total"):
        np.testing.assert_allclose(end.sel(index=kind), [16 / 17, 1 / 17], atol=0.02)
    assert (out["f confidence"].isel(time=1) < 0.2).all()
