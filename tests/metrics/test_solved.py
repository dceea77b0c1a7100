"""Metrics of models that were solved, against what the solution must obey."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import febkit
from febkit import templates
from febkit.metrics import cell_metrics, element_fields
from febkit.results import open as open_results

STUDY = Path(__file__).parents[2].parent / "shared" / "oracle" / "study"
TIMES = [0.0, *np.round(np.arange(1, 13) * 0.05, 10).tolist()]


def solved(folder: Path, vertical: int):
    """A column in confined compression that drains at the top, every step plotted: model and plotfile."""
    model = templates.new("tissue", case="B", n=1, vertical=vertical, centre=0.0, edge=0.1, depth=0.002, times=TIMES,
                          first_step=0.05, updates=0, dtol=1e-8, etol=1e-16, ptol=1e-8)
    febkit.write(model, folder / "column.feb")
    model = febkit.read(folder / "column.feb")
    result = febkit.solve(model, folder / "column.xplt")
    assert result.converged and result.totals.steps == len(TIMES) - 1, result.reason
    return model, folder / "column.xplt"


@pytest.fixture(scope="module")
def column(tmp_path_factory):
    return solved(tmp_path_factory.mktemp("column"), 40)


def test_fluid_leaves_a_slab_as_fast_as_it_shrinks(column, tmp_path):
    """Divergence theorem: mass exchange = -rho dV/dt of a part of the column, to 1 % of its peak, order 2."""
    error = []
    for (model, path), n in ((column, 40), (solved(tmp_path, 80), 80)):
        with open_results(path) as ds:
            bare = ds.drop_vars([v for v in ("nodal_fluid_flux", "fluid_flux") if v in ds])
            slab = {"slab": np.arange(n // 2, n - n // 10)}
            m = cell_metrics(bare, model, slab).isel(cell=0, time=slice(1, None))
            plotted = cell_metrics(ds, model, slab).isel(cell=0, time=slice(1, None))
        rate, balance = m.mass_exchange_rate.values, m.volume_loss_rate.values
        assert (rate > 0).any() and (rate < 0).any()
        error.append(np.abs(rate - balance).max() / np.abs(balance).max())
        # the plotfile's nodal fluxes and those recovered from pressure are the same
        np.testing.assert_allclose(plotted.mass_exchange_rate, rate, atol=1e-3 * np.abs(rate).max())
    assert max(error) < 0.01
    assert error[0] / error[1] > 3.5


def chondrocyte(folder: Path, fine: int) -> tuple[np.ndarray, np.ndarray]:
    """Mass exchange and -rho dV/dt of a soft cell in its PCM, compressed in two steps that are both plotted."""
    model = templates.new("cell", case="C", times=[0, 2, 4], ramp=4.0, first_step=2.0, longest_step=2.0, ramp_step=2.0,
                          n=6 * fine, block=4 * fine, edge=0.04, cells=1, layers=[2 * fine] * 3,
                          updates=0, dtol=1e-6, etol=1e-12, ptol=1e-6)  # fmt: skip
    febkit.write(model, folder / f"cell{fine}.feb")
    model = febkit.read(folder / f"cell{fine}.feb")
    assert febkit.solve(model, folder / f"cell{fine}.xplt").totals.steps == 2
    with open_results(folder / f"cell{fine}.xplt") as ds:
        m = cell_metrics(ds, model).isel(cell=0, time=slice(1, None))
        return m.mass_exchange_rate.values, m.volume_loss_rate.values


def test_fluid_leaves_a_chondrocyte_as_fast_as_it_shrinks(tmp_path):
    """Divergence theorem at a cell: nodal fluxes (eq 17) err by the first order in the elements at the surface, where
    the soft cell's pressure falls steeply; in the limit of fine meshes the exchange is -rho dV/dt to 1 %."""
    (rate, balance), (fine, fine_balance) = chondrocyte(tmp_path, 1), chondrocyte(tmp_path, 2)
    assert (rate > 0).all() and (fine_balance > 0).all()
    error, fine_error = np.abs(rate / balance - 1), np.abs(fine / fine_balance - 1)
    assert (error > 1.9 * fine_error).all() and (fine_error < 0.08).all()
    np.testing.assert_allclose(2 * fine - rate, 2 * fine_balance - balance, rtol=0.01)


def test_recomputed_fields_are_those_of_the_plotfile(column):
    """Element means of flux and volume recomputed from displacement and pressure."""
    model, path = column
    with open_results(path) as ds:
        f = element_fields(ds.drop_vars("fluid_flux"), "*", model)
        scale = float(np.abs(ds["fluid_flux"]).max())
        assert f["fluid_flux"].attrs["units"] == "um/s" and ds["fluid_flux"].attrs["units"] == "mm/s"
        assert np.allclose(f["fluid_flux"] / 1e3, ds["fluid_flux"], atol=2e-4 * scale)
        total = f["volume"].sum("element").values
        assert total[-1] == pytest.approx(100.0 * 100.0 * (100.0 - 2.0), rel=1e-6)  # um^3


@pytest.mark.skipif(not STUDY.is_dir(), reason="FEBio's own answers are not there")
def test_flux_and_stress_agree_with_febio():
    """FEBio 4.11's last state of the driven cell model: element mean flux and effective stress."""
    import xarray as xr

    model = febkit.read(STUDY / "models" / "cell_driven.feb")
    ref = np.load(STUDY / "reference" / "cell_driven.npz")
    ds = _as_result(model, ref["u"][-1:], ref["p"][-1:], ref["times"][-1:])
    f = element_fields(ds, "*", model)
    at = np.searchsorted(f["element_id"].values, ref["flux_elem"])
    scale = np.abs(ref["flux"]).max()
    assert np.abs(f["fluid_flux"].values[0, at] - ref["flux"]).max() < 2e-3 * scale
    from febkit.metrics.tensors import effective

    # the plotfile holds element means: the effective value of the mean is at most the mean of the values
    own = f["effective_stress"].values[0, np.searchsorted(f["element_id"].values, ref["stress_elem"])]
    of_mean = effective(ref["stress"].T.astype(float))  # neither names units: both are the model's plain numbers
    assert "units" not in f["effective_stress"].attrs
    assert (of_mean <= own * (1 + 1e-3)).all()
    assert np.median(of_mean / own) > 0.97
    m = cell_metrics(ds, model)
    assert isinstance(m, xr.Dataset) and m.sizes["cell"] == 11


def _as_result(model, u, p, times):
    import xarray as xr

    blocks = model.mesh.blocks
    part = np.repeat(np.arange(len(blocks)), [len(b.ids) for b in blocks])
    coords = {
        "time": np.asarray(times, float), "xyz": ["x", "y", "z"], "X": (("node", "xyz"), model.mesh.X),
        "node_id": ("node", model.mesh.node_ids), "part": ("element", part),
        "element_id": ("element", np.concatenate([b.ids for b in blocks])),
        "element_type": ("element", np.zeros(len(part), int)),
        "connectivity": (("element", "local"), np.concatenate([b.conn for b in blocks])),
    }
    data = {"displacement": (("time", "node", "xyz"), u), "effective_fluid_pressure": (("time", "node"), p)}
    return xr.Dataset(data, coords, {"parts": [b.name for b in blocks], "element_types": ["hex8"]})
