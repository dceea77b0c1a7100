"""One cell model in three unit systems: the same metrics, through files and the command."""

from __future__ import annotations

import csv
import io
import re
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import febkit
from febkit import results, templates
from febkit.cli.main import cli
from febkit.model import InputError

# what a number of mm-N-s is multiplied by: lengths, stresses, permeabilities
SCALES = {"mm-N-s": (1.0, 1.0, 1.0), "SI": (1e-3, 1e6, 1e-12), "um-nN-s": (1e3, 1e3, 1e3)}
COLUMNS = {
    "aspect_ratio_change", "volumetric_strain", "effective_strain", "effective_stress (kPa)", "max_shear_strain",
    "mass_exchange_rate (pg/s)", "volume (um^3)", "volume_loss_rate (pg/s)", "axes_ratio_change",
}  # fmt: skip


def call(*args: object, code: int = 0) -> tuple[str, str]:
    """What the command prints, and what it says beside it, in this process: starting one takes a second."""
    done = CliRunner().invoke(cli, [str(a) for a in args])
    if code == 0 or done.exit_code == 2:  # of the usage
        assert done.exit_code == code, done.output + str(done.exception)
        return done.stdout, done.stderr
    assert isinstance(done.exception, InputError), done.output + str(done.exception)
    return done.stdout, str(done.exception)


def scaled(text: str, system: str) -> str:
    """The model of mm-N-s in another system; its motion, u = -0.1 Z at the surface, is the same in all."""
    length, stress, permeability = SCALES[system]
    by = {"E": stress, "perm": permeability}
    text = re.sub(r"<(E|perm)>(.*?)<", lambda m: f"<{m[1]}>{float(m[2]) * by[m[1]]!r}<", text)
    text = re.sub(
        r'(<node id="\d+">)(.*?)<',
        lambda m: m[1] + ",".join(repr(float(x) * length) for x in m[2].split(",")) + "<", text,
    )  # fmt: skip
    return text.replace("<units>mm-N-s</units>", f"<units>{system}</units>")


def in_system(ds: xr.Dataset, system: str) -> xr.Dataset:
    """The result of mm-N-s in another system, in double precision."""
    length, stress, _ = SCALES[system]
    by = {"X": length, "displacement": length, "effective_fluid_pressure": stress, "stress": stress,
          "solid_stress": stress, "fluid_flux": length, "nodal_fluid_flux": length}  # fmt: skip
    attrs = {n: ds[n].attrs | {"units": ""} for n in by}
    changed = {n: (ds[n].astype(float) * k).assign_attrs(attrs[n]) for n, k in by.items()}
    return ds.assign(changed).assign_coords(X=changed["X"]).assign_attrs(unit_system=system)


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> Path:
    """A model by the name of each system, its plotfile, and the result in double precision beside it."""
    folder = tmp_path_factory.mktemp("units")
    model = templates.new("cell", n=5, cells=1, layers=[1, 1, 1], edge=0.05, times=[0.0, 0.1, 1.0])
    febkit.write(model, folder / "source.feb")
    text = (folder / "source.feb").read_text()
    for system in SCALES:
        (folder / f"{system}.feb").write_text(scaled(text, system))
    for system in ("mm-N-s", "um-nN-s"):  # in metres, tolerances that are FEBio's and have units stop too early
        assert febkit.solve(febkit.read(folder / f"{system}.feb"), folder / f"{system}.xplt").converged
    ds = febkit.open_results(folder / "mm-N-s.xplt").load()
    for system in SCALES:
        results.write(in_system(ds, system), folder / f"{system}.nc")
    results.write(in_system(ds, "SI"), folder / "SI.xplt")
    return folder


def table(text: str) -> dict[str, np.ndarray]:
    """Columns of numbers of a CSV file."""
    rows = list(csv.DictReader(io.StringIO(text)))
    return {k: np.array([float(r[k] or "nan") for r in rows]) for k in rows[0] if k not in ("cell", "part")}


@pytest.fixture(scope="module")
def measured(runs: Path) -> Callable[..., dict[str, np.ndarray]]:
    """``measured("SI", "nc", "nodal")``: metrics of a result, each measured once."""

    @cache
    def measure(system: str, end: str, exchange: str) -> dict[str, np.ndarray]:
        out = runs / f"{system}_{end}_{exchange}.csv"
        call("metrics", runs / f"{system}.{end}", "-m", runs / f"{system}.feb", "--exchange", exchange, "-o", out)
        return table(out.read_text())

    return measure


@pytest.mark.parametrize("exchange", ["nodal", "consistent"])
@pytest.mark.parametrize("system", ["SI", "um-nN-s"])
def test_the_same_metrics_in_every_system(
    measured: Callable[..., dict[str, np.ndarray]], system: str, exchange: str
) -> None:
    """To 1e-9 of doubles; plotfiles, that of um-nN-s from a solve of its own, to what their single precision leaves."""
    found = {(name, end): measured(name, end, exchange) for name in ("mm-N-s", system) for end in ("nc", "xplt")}
    assert set(found[system, "nc"]) - {"time (s)"} == COLUMNS
    for end, rtol in (("nc", 1e-9), ("xplt", 2e-3)):
        for column, a in found["mm-N-s", end].items():
            b = found[system, end][column]
            np.testing.assert_allclose(b, a, rtol=0, atol=rtol * np.nanmax(np.abs(a)) + 1e-300, err_msg=column)
    stress = found[system, "nc"]["effective_stress (kPa)"][-1]
    assert 0.01 < stress < 1.0  # of a cell of 1 kPa, pressed by a tenth in a stiffer surrounding


def test_terminal_csv_and_files_say_the_same_numbers(runs: Path) -> None:
    source = ("metrics", runs / "um-nN-s.xplt")
    out, _ = call(*source, "--style", "csv", "-o", runs / "a.csv")
    call(*source, "-o", runs / "a.nc")
    printed, kept = table(out), table((runs / "a.csv").read_text())
    with xr.open_dataset(runs / "a.nc") as ds:
        assert ds.attrs["unit_system"] == "um-nN-s" and ds.time.attrs["units"] == "s"
        for name, shown in (("effective_stress", "effective stress"), ("mass_exchange_rate", "mass exchange")):
            unit = ds[name].attrs["units"]
            value = float(ds[name][0, -1])
            assert printed[f"{shown} ({unit})"][-1] == kept[f"{name} ({unit})"][-1] == value
    out, _ = call(*source, "--style", "text")
    assert "t = 1 s" in out and f"{kept['effective_stress (kPa)'][-1]:.4g}" in out


def test_summaries_name_their_units(runs: Path) -> None:
    """Stresses in kPa, everything else in the units of its system, in the terminal and in the file."""
    for variable, units, factor in (("stress:effective", {"SI": "kPa", "um-nN-s": "kPa"}, 1.0),
                                    ("displacement:magnitude", {"SI": "m", "um-nN-s": "um"}, 1e6)):  # fmt: skip
        got = {}
        for system, unit in units.items():
            out, _ = call("metrics", runs / f"{system}.nc", "-v", variable, "-p", "ecm", "--style", "csv",
                          "-o", runs / "v.csv")  # fmt: skip
            got[system] = table(out)[f"mean ({unit})"][-1]
            assert table((runs / "v.csv").read_text())[f"mean ({unit})"][-1] == got[system]
        assert got["um-nN-s"] == pytest.approx(got["SI"] * factor, rel=1e-9)


@pytest.fixture(scope="module")
def unnamed(runs: Path) -> Path:
    """The model of um-nN-s, which says nothing of its units, and its result."""
    folder = runs / "unnamed"
    folder.mkdir()
    text = (runs / "um-nN-s.feb").read_text()
    (folder / "cell.feb").write_text(re.sub(r"<units>.*?</units>", "", text))
    call("run", folder / "cell.feb")
    return folder / "cell.xplt"


def test_numbers_are_plain_where_nobody_names_units(runs: Path, unnamed: Path) -> None:
    """No kPa, no density of water; the terminal says so and how to tell."""
    out, said = call("metrics", unnamed, "-o", unnamed.with_suffix(".csv"), "--style", "csv")
    assert "--units SYSTEM tells" in said
    assert "kPa" not in out and "pg" not in out and "volume exchange" in out
    plain, named = table(unnamed.with_suffix(".csv").read_text()), {}
    call("metrics", runs / "um-nN-s.xplt", "-o", runs / "named.csv")
    named = table((runs / "named.csv").read_text())
    assert "(" not in "".join(plain)
    # um-nN-s: stress is in kPa and a cubic length of water weighs a pg, so the numbers are the same here
    np.testing.assert_array_equal(plain["effective_stress"], named["effective_stress (kPa)"])
    np.testing.assert_array_equal(plain["mass_exchange_rate"], named["mass_exchange_rate (pg/s)"])
    with febkit.open_results(unnamed) as ds:
        assert "unit_system" not in ds.attrs and "units" not in ds["stress"].attrs
        assert ds["Lagrange_strain"].attrs["units"] == "1"


def test_info_names_units_where_they_are_known(runs: Path, unnamed: Path) -> None:
    def ends(path: Path) -> dict[str, str]:
        lines = call("info", path)[0].splitlines()
        found = {n: next(x for x in lines if x.startswith(f"  {n}  ")) for n in ("displacement", "stress")}
        return {n: x.rpartition("] ")[2] for n, x in found.items()}

    assert ends(runs / "SI.xplt") == {"displacement": "m", "stress": "Pa"}
    assert all(x.endswith("]") for x in ends(unnamed).values())


def test_units_can_be_told(runs: Path, unnamed: Path) -> None:
    told, said = call("metrics", unnamed, "--units", "um-nN-s", "--style", "csv")
    named, _ = call("metrics", runs / "um-nN-s.xplt", "--style", "csv")
    assert told == named and "units:" not in said
    call("metrics", unnamed, "--units", "um-nN-s", "-o", runs / "told.nc")
    out, _ = call("compare", runs / "told.nc", unnamed, "--units", "um-nN-s", "--style", "markdown")
    assert "effective stress (kPa)" in out
    with febkit.open_results(unnamed, units="SI") as ds:
        assert ds["stress"].attrs["units"] == "Pa" and ds["X"].attrs["units"] == "m"


def test_what_contradicts_itself_is_refused(runs: Path, unnamed: Path) -> None:
    """Another system than the file's, a model of another system, metrics with and without units."""
    _, said = call("metrics", runs / "SI.xplt", "--units", "mm-N-s", code=2)
    assert "differ in units: SI and mm-N-s" in said
    _, said = call("metrics", runs / "SI.xplt", "-m", runs / "mm-N-s.feb", code=2)
    assert "differ in units: SI and mm-N-s" in said
    call("metrics", unnamed, "-o", runs / "plain.nc")
    _, said = call("compare", runs / "um-nN-s.xplt", runs / "plain.nc", code=2)
    assert "units that nobody named" in said and "--units" in said
    _, said = call("compare", runs / "plain.nc", unnamed, "--units", "SI", code=2)
    assert "measure the result again with --units SI" in said
    _, said = call("metrics", unnamed, "--units", "inch", code=2)
    assert "mm-N-s" in said


def test_systems_can_be_compared(runs: Path) -> None:
    """Control in metres, test in micrometres: no difference but that of rounding."""
    out, _ = call("compare", runs / "SI.nc", runs / "um-nN-s.nc", "--style", "csv", "-o", runs / "c.nc")
    assert "effective stress (kPa)" in out
    with xr.open_dataset(runs / "c.nc") as ds:
        assert float(ds["nrms"].max()) < 1e-9


def test_a_study_tells_the_units_of_adopted_results(tmp_path: Path, runs: Path, unnamed: Path) -> None:
    from febkit.study.work import Job, drive, measure, series

    shutil.copy(unnamed, tmp_path / "run.xplt")
    shutil.copy(unnamed.with_suffix(".feb"), tmp_path / "model.feb")
    here = {"model": tmp_path, "results": tmp_path}
    measure(Job(tmp_path, {"units": "um-nN-s", "sides": "cell"}, here, {}, {}))
    with xr.open_dataset(tmp_path / "metrics.nc") as ds:
        assert ds.attrs["unit_system"] == "um-nN-s" and ds["effective_stress"].attrs["units"] == "kPa"
    series(Job(tmp_path, {"units": "um-nN-s", "points": [[0, 0, 0]], "order": 1}, here, {}, {}))
    shutil.copy(runs / "SI.feb", tmp_path / "model.feb")
    params = {"point": 0, "solid": 1, "fluid": 1}
    with pytest.raises(InputError, match="the tissue and the cell model differ in units: um-nN-s and SI"):
        drive(Job(tmp_path, params, {"cell": tmp_path, "series": tmp_path}, {}, {}))


def test_the_hand_off_carries_units(runs: Path, unnamed: Path) -> None:
    for system, length, stress in (("SI", "m", "Pa"), ("um-nN-s", "um", "kPa")):
        series = runs / f"series_{system}.nc"
        call("boundary", runs / f"{system}.xplt", "--at", "0,0,0", "--dataset", series)
        with xr.open_dataset(series) as ds:
            assert ds.attrs["unit_system"] == system
            units = {n: ds[n].attrs.get("units") for n in ("u", "F", "G", "p", "grad_p", "X", "time", "element_size")}
        assert units == {"u": length, "F": "1", "G": f"1/{length}", "p": stress, "grad_p": f"{stress}/{length}",
                         "X": length, "time": "s", "element_size": length}  # fmt: skip
    cell = runs / "mm-N-s.feb"
    _, said = call("boundary", runs / "SI.xplt", cell, "--at", "0,0,0", "-o", runs / "driven.feb", code=2)
    assert "the tissue and the cell model differ in units: SI and mm-N-s" in said
    _, said = call("boundary", runs / "series_SI.nc", cell, "-o", runs / "driven.feb", code=2)
    assert "differ in units" in said
    assert not (runs / "driven.feb").exists()
    out, err = call("boundary", unnamed, runs / "um-nN-s.feb", "--at", "0,0,0", "-o", runs / "driven.feb")
    assert "taken to be in those of the cell model, um-nN-s" in out + err
    out, err = call("boundary", unnamed, runs / "um-nN-s.feb", "--at", "0,0,0", "-o", runs / "told.feb",
                    "--units", "um-nN-s")  # fmt: skip
    assert "taken to be" not in out + err


def test_figures_name_units_only_where_they_are_known(runs: Path, unnamed: Path) -> None:
    pytest.importorskip("matplotlib")
    words = {}
    for name, source, told in (("known", runs / "SI.xplt", ()), ("plain", unnamed, ()),
                               ("told", unnamed, ("--units", "um-nN-s"))):  # fmt: skip
        text = ""
        for kind in (("histories",), ("section", "-f", "effective_stress", "--at", "0")):
            out = runs / "figure.svg"
            call("plot", *kind, source, *told, "-o", out)
            text += re.sub(r"<!--\s*(.*?)\s*-->", r"[\1]", out.read_text())
        words[name] = set(re.findall(r"\[([^\]]*)\]", text))
    assert {"time (s)", "effective stress (kPa)", "mass exchange (pg/s)", "x (m)"} <= words["known"]
    assert {"time", "effective stress", "volume exchange", "x"} <= words["plain"]
    assert {"x (µm)", "effective stress (kPa)"} <= words["told"]
