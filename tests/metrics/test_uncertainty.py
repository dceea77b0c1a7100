"""What the error of a hand-off makes of metrics: by hand, and where it is not known."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from febkit.metrics import cell_metrics
from febkit.model import InputError

from .conftest import ball, result

TIMES = (0.0, 1.0, 2.0)


def pressed(X: np.ndarray, t: float) -> np.ndarray:
    """Shortened along z by a tenth at time 1, a fifth at time 2."""
    return X * np.array([1.0, 1.0, 1.0 - 0.1 * t])


@pytest.fixture
def cells() -> xr.Dataset:
    X, conn = ball(3)
    return result(X, [("hex8", "cell", conn)], pressed, TIMES)


def error(**more: object) -> xr.Dataset:
    return xr.Dataset({"strain_error": ("time", [0.0, 0.03, 0.04]), "strain_scale": ("time", [0.0, 0.1, 0.2]),
                       **more}, {"time": list(TIMES)})  # fmt: skip


def test_strains_answer_by_their_secant_to_the_strain_handed_over(cells):
    got = cell_metrics(cells, cells="cell", error=error())
    for name in ("effective_strain", "volumetric_strain", "max_shear_strain", "aspect_ratio_change"):
        top = float(np.abs(got[name]).max())
        assert got[f"{name}_uncertainty"].values[0] == pytest.approx([0.0, top * 0.15, top * 0.2], rel=1e-12)
        assert got[f"{name}_uncertainty"].attrs["units"] == "1"
        assert "formula" in got[f"{name}_uncertainty"].attrs
    # volumetric strain -0.2 at the end, of a strain scale of 0.2: an error of 0.04 in the strain is one of 0.04 in it
    assert got["volumetric_strain_uncertainty"].values[0, 2] == pytest.approx(0.04, rel=1e-9)
    assert "without the error of the pressure" in got.attrs["uncertainty"]
    assert "not known of volume" in got.attrs["uncertainty"]
    assert "volume_uncertainty" not in got


def test_rates_come_about_in_their_time(cells):
    got = cell_metrics(cells, cells="cell", error=error())
    rate = got["volume_loss_rate_uncertainty"].values[0]
    assert np.isnan(rate[0])
    assert rate[1:] == pytest.approx(got["volume"].values[0, 0] * np.array([0.03 / 1, 0.04 / 2]), rel=1e-9)


def test_the_pressure_gradient_strains_by_the_modulus_once_fluid_has_moved(cells):
    """Half an edge of 1 times 0.06 over a modulus of 0.75 is a strain of 0.04: with 0.03, 0.05. It takes a^2 / H k."""
    def of_p(k):
        return {"grad_p_error": ("time", [0.0, 0.06, 0.0]), "modulus": 0.75, "permeability": k,
                "box": (("end", "i"), [[-0.5] * 3, [0.5] * 3])}  # fmt: skip

    at_once = cell_metrics(cells, cells="cell", error=error(**of_p(1e3)))
    assert at_once["volumetric_strain_uncertainty"].values[0] == pytest.approx([0.0, 0.05, 0.04], rel=1e-6)
    assert "pressure" not in at_once.attrs["uncertainty"]
    slow = cell_metrics(cells, cells="cell", error=error(**of_p(1 / 3)))  # in a time of 1
    drag = 0.04 * (1 - np.exp(-1))
    assert slow["volumetric_strain_uncertainty"].values[0] == pytest.approx(
        [0.0, np.hypot(0.03, drag), np.hypot(0.04, drag * np.exp(-1))], rel=1e-9)
    rate = slow["volume_loss_rate_uncertainty"].values[0] / slow["volume"].values[0, 0]
    assert rate == pytest.approx([0.0, 0.03 / 2 + drag, 0.04 / 3 + drag * np.exp(-1)], rel=1e-9)


def test_times_without_an_estimate_have_no_uncertainty(cells):
    got = cell_metrics(cells, cells="cell", error=error().isel(time=slice(0, 2)))
    assert np.isnan(got["effective_strain_uncertainty"].values[0, 2])
    assert not [n for n in cell_metrics(cells, cells="cell") if str(n).endswith("_uncertainty")]


def test_what_is_no_estimate_is_refused(cells):
    with pytest.raises(InputError, match="strain_error over time"):
        cell_metrics(cells, cells="cell", error=cells)


def test_the_command_prints_and_writes_it(cells, tmp_path):
    from helpers.forked import febkit

    series = xr.Dataset(
        {"F": (("point", "time", "i", "J"), np.tile(np.eye(3), (2, 3, 1, 1))),
         "strain_error": (("handed_order", "point", "time"), np.tile([[0.0], [0.04]], (3, 1, 3))),
         "strain_error_by_part": (("part", "handed_order", "point", "time"), np.zeros((4, 3, 2, 3))),
         "strain_scale": (("point", "time"), np.full((2, 3), 0.2))},
        {"time": list(TIMES), "point": ["a", "b"], "handed_order": [1, 2, 3],
         "part": ["departure", "truncation", "mesh", "swing"]})  # fmt: skip
    series.to_netcdf(tmp_path / "s.nc")
    cells.to_netcdf(tmp_path / "run.nc")
    told = ["metrics", "run.nc", "-c", "cell", "--handoff", "s.nc"]
    said = febkit(*told, "--point", "b", "-o", "m.nc", folder=tmp_path)
    assert said.returncode == 0 and "± effective strain" in said.stdout, said.stdout + said.stderr
    assert "no bound" in said.stdout + said.stderr
    with xr.open_dataset(tmp_path / "m.nc") as ds:
        assert float(ds["volumetric_strain_uncertainty"][0, 1]) == pytest.approx(0.04, rel=1e-9)
    said = febkit(*told, "--point", "c", folder=tmp_path)
    assert said.returncode == 2 and "there is a, b" in said.stderr
