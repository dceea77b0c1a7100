"""The verbs metrics, compare and plot on a small result, through the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr
from click.testing import CliRunner

import febkit
from febkit import templates
from febkit.cli import metrics
from febkit.cli.main import cli
from febkit.model import InputError


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("cell")
    model = templates.new("cell", n=5, cells=1, layers=[1, 1, 1], edge=0.05, times=[0.0, 0.1, 1.0])
    febkit.write(model, folder / "cell.feb")
    assert febkit.solve(febkit.read(folder / "cell.feb"), folder / "cell.xplt").converged
    return folder


def call(*args: object) -> str:
    result = CliRunner().invoke(cli, [str(a) for a in args], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_metrics_to_table_and_file(run):
    out = call("metrics", run / "cell.xplt", "-o", run / "a.nc", "--style", "text", "--at", 0.1)
    assert "t = 0.1" in out and "cell_1" in out and "effective stress (kPa)" in out
    with xr.open_dataset(run / "a.nc") as ds:
        assert "integration points" in ds.effective_stress.attrs["how"]
    call("metrics", run / "cell.xplt", "-o", run / "a.csv", "--style", "csv")
    head, *rows = (run / "a.csv").read_text().splitlines()
    assert head.startswith("cell,time (s),aspect_ratio_change") and len(rows) == 3


def test_a_table_of_no_state_ends_in_words():
    none = xr.Dataset({"a": (("cell", "time"), [[]])}, coords={"cell": ["c"], "time": []})
    with pytest.raises(InputError, match="holds no state"):
        metrics._printed(none, ["a"], "cell", (), "text")


def test_consistent_exchange(run):
    for method in ("nodal", "consistent"):
        call("metrics", run / "cell.xplt", "--exchange", method, "-o", run / f"{method}.nc")
    with xr.open_dataset(run / "nodal.nc") as a, xr.open_dataset(run / "consistent.nc") as b:
        assert (a.mass_exchange_rate.attrs["exchange"], a.mass_exchange_rate.attrs["sides"]) == ("nodal", "both")
        about = b.mass_exchange_rate.attrs
        assert about["exchange"] == "consistent" and "Hughes" in about["source"]
        assert abs(a.mass_exchange_rate - b.mass_exchange_rate)[0, -1] > 0


def test_summary_and_fields(run):
    out = call("metrics", run / "cell.xplt", "-v", "stress:effective", "-p", "pcm_1", "--style", "csv")
    assert "pcm_1" in out
    head, row = (x.split(",") for x in out.strip().splitlines())
    assert [h for h in head if "quantile" in h] == [f"quantile {q:g} (kPa)" for q in (0.05, 0.25, 0.5, 0.75, 0.95)]
    numbers = [float(x) for x in row[2:]]  # least, quantiles, greatest
    assert numbers == sorted(numbers) and numbers[0] < numbers[-1]
    out = call("metrics", run / "cell.xplt", "-v", "stress:effective", "-p", "ecm", "-q", 0.5, "--style", "csv",
               "-o", run / "q.csv")  # fmt: skip
    assert "quantile 0.5" in out and "quantile 0.95" not in out
    assert (run / "q.csv").read_text().splitlines()[0] == (
        "part,time (s),mean (kPa),least (kPa),greatest (kPa),quantile_0.5 (kPa)"
    )
    call("metrics", run / "cell.xplt", "--fields", "-c", "pcm_1", "-o", run / "f.nc")
    with xr.open_dataset(run / "f.nc") as ds:
        assert set(ds.data_vars) >= {"effective_strain", "effective_stress", "fluid_flux", "volume", "principal_stress"}


def test_compare_and_plot(run):
    call("metrics", run / "cell.xplt", "-o", run / "a.nc")
    out = call("compare", run / "a.nc", run / "cell.xplt", "-l", "again", "--style", "markdown", "-o", run / "c.nc")
    assert "| again | 0.00e+00 (0.000)" in out
    with xr.open_dataset(run / "c.nc") as ds:
        assert float(ds.rms.max()) == 0
    pytest.importorskip("matplotlib")
    for args in (("histories", run / "a.nc"), ("exchange", run / "a.nc"), ("bland-altman", run / "a.nc", run / "a.nc"),
                 ("errors", run / "a.nc", run / "a.nc"), ("section", run / "cell.xplt", "--at", 0.001)):
        call("plot", *args, "-o", run / "p.png")
        assert (run / "p.png").stat().st_size > 5000
        (run / "p.png").unlink()


def test_mistakes_are_told_by_name(run):
    with pytest.raises(InputError, match="pcm_1"):
        call("metrics", run / "cell.xplt", "-c", "nucleus")
    with pytest.raises(InputError, match="nearest"):
        call("metrics", run / "cell.xplt", "--at", 7)
    with pytest.raises(InputError, match="it has"):
        call("metrics", run / "cell.xplt", "-v", "temperature")
