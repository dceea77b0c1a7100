"""Agreement statistics against numbers worked out by hand, and the tables made of them."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
import xarray as xr

from febkit.metrics import (
    align,
    at_moments,
    bland_altman,
    compare,
    compare_orders,
    rank_correlation,
    spread,
    summarize,
    tables,
)
from febkit.metrics.agreement import fisher_z
from febkit.metrics.summary import mean, weighted_quantiles
from febkit.model import InputError

TIMES = [0.0, 0.1, 1.0, 100.0]


def cells(values: np.ndarray, name: str = "effective_strain", units: str = "1") -> xr.Dataset:
    n = len(values)
    return xr.Dataset({name: (("cell", "time"), values, {"units": units})},
                      coords={"cell": [f"cell{i + 1}" for i in range(n)], "time": TIMES[: values.shape[1]]})


def test_rms_and_limits():
    a = cells(np.array([[0.0, 1, 2, 4], [0, 1, 2, 3]]))
    b = a + xr.DataArray([[1.0, 1, 1, 1], [-1, -1, -1, -1]], dims=("cell", "time"))
    r = compare(a, b).sel(metric="effective_strain")
    assert float(r.rms) == 1 and float(r.range) == 3 and float(r.nrms) == pytest.approx(1 / 3)
    s = np.sqrt(6 / 5)
    assert float(r.bias) == 0 and float(r.upper) == pytest.approx(1.96 * s)
    assert int(r.outside) == 0 and int(r.n) == 6  # the reference state does not count


def test_the_reference_state_does_not_count():
    """11 cells at the study's 29 times after t = 0 are n = 319."""
    t = np.arange(30.0)
    a = xr.Dataset({"effective_strain": (("cell", "time"), np.outer(np.ones(11), t))}, {"cell": range(11), "time": t})
    r = compare(a, a + 2 * (a.time > 0)).sel(metric="effective_strain")
    assert int(r.n) == 319 and float(r.rms) == 2
    assert bland_altman(a, a).sizes["time"] == 29
    assert int(compare(a.isel(time=[0]), a.isel(time=[0])).n[0]) == 11  # where there is nothing else


def test_outliers_are_counted_where_they_are():
    rng = np.random.default_rng(1)
    a = cells(rng.normal(size=(11, 4)))
    b = a + xr.DataArray(1e-3 * rng.normal(size=(11, 4)), dims=("cell", "time"))
    b.effective_strain[7, 2] += 1
    ba = bland_altman(a, b)
    assert int(ba.outside.sum()) == 1 and bool(ba.outside.sel(cell="cell8", time=1.0).item())
    assert int(compare(a, b).outside[0]) == 1


def test_moments_and_spread():
    v = np.array([[0, 5.0, -9, 2], [0, 1, 2, 3], [0, 4, 1, 1]])
    m = at_moments(cells(v)).effective_strain
    assert m.sel(moment="instantaneous").values.tolist() == [5, 1, 4]
    assert m.sel(moment="steady").values.tolist() == [2, 3, 1]
    assert m.sel(moment="peak").values.tolist() == [-9, 3, 4]
    s = spread(cells(v)).sel(metric="effective_strain", moment="peak")
    assert (float(s["median"]), float(s.least), float(s.greatest)) == (3, -9, 4)
    with pytest.raises(InputError, match=r"0\.3"):
        at_moments(cells(v), instantaneous=0.3)
    with pytest.raises(InputError, match="holds no state"):
        at_moments(cells(v).isel(time=[]))


def test_ranks_and_fisher():
    rng = np.random.default_rng(2)
    base = np.outer(np.arange(11.0), [0, 1, 1, 1])
    swapped = base.copy()
    swapped[[3, 4]] = swapped[[4, 3]]
    r = rank_correlation(cells(base), cells(np.exp(base)))
    assert np.allclose(r.rho.sel(metric="effective_strain"), 1)
    c = compare_orders(cells(base), cells(swapped), cells(rng.permutation(base)))
    n, d2 = 11, 2
    assert np.allclose(c.rho_first, 1 - 6 * d2 / (n * (n**2 - 1)))
    assert (c.p >= 0).all() and (c.p <= 1).all()
    flat = rank_correlation(cells(base), cells(base * 0))
    assert np.isnan(flat.rho).all()


def test_fisher_z_of_known_correlations():
    z, p = fisher_z(np.array([0.5, 0.9]), np.array([0.5, 0.1]), 11, 11)
    assert z[0] == 0 and p[0] == 1
    assert z[1] == pytest.approx((np.arctanh(0.9) - np.arctanh(0.1)) * 2)
    assert p[1] == pytest.approx(math.erfc(abs(z[1]) / math.sqrt(2)), rel=1e-12)


def test_times_of_single_precision_meet():
    a, b = cells(np.ones((2, 4))), cells(np.ones((2, 4)))
    b = b.assign_coords(time=np.float32(TIMES).astype(float))
    assert align(a, b)[0].sizes["time"] == 4
    with pytest.raises(InputError, match="no time"):
        align(a, b.assign_coords(time=[7.0, 8, 9, 10]))
    with pytest.raises(InputError, match="no cell"):
        align(a, b.assign_coords(cell=["x", "y"]))


def test_tables_say_the_same_in_every_style():
    a = cells(np.array([[0.0, 1, 2, 4], [0, 1, 2, 3]]), "effective_stress", "kPa")
    r = compare(a, a * 1.5)
    t = tables.rms_table([("A1", r)])
    assert "effective stress (kPa)" in t.columns
    rms = float(r.rms[0])
    for style in ("text", "markdown", "csv"):
        assert f"{rms:.2e}" in t.render(style)
    assert "8/8" not in tables.limits_table(r).text()
    assert len(tables.spread_table([("A", spread(a))]).rows) == 3


def test_weighted_quantiles_of_uniform_values():
    v = np.arange(1000.0)
    assert weighted_quantiles(v, np.ones(1000), [0.25, 0.5])[1] == pytest.approx(499.5)
    # twice the weight is the same as the value twice
    doubled = weighted_quantiles(np.array([1.0, 2, 3]), np.array([1.0, 2, 1]), [0.5])
    assert doubled == pytest.approx([2.0])


def test_an_element_without_a_value_counts_for_nothing_and_says_nothing(mesh, make):
    X, conn = mesh(2)
    ds = make(X, [("hex8", "tissue", conn)], lambda X, t: X)
    values = np.ones((ds.sizes["time"], len(conn), 8))
    values[:, 0], values[:, 1, :4] = np.nan, np.nan
    ds["nodal_density"] = (("time", "element", "local"), values)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.allclose(mean(ds, "nodal_density"), 1)


def test_summary_of_a_part(mesh, make):
    X, conn = mesh(3)
    X2 = np.vstack([X, X + 4])
    blocks = [("hex8", "ecm", conn), ("hex8", "cell1", conn + len(X))]
    ds = make(X2, blocks, lambda X, t: X * (1 + t))
    s = np.zeros((2, 54, 6))
    s[:, :, 0] = np.arange(54)
    ds["stress"] = (("time", "element", "voigt"), s)
    ds = ds.assign_coords(voigt=["xx", "yy", "zz", "xy", "yz", "xz"])
    r = summarize(ds, "stress:xx")
    assert r.least.sel(part="cell1").values.tolist() == [27, 27]
    assert r.greatest.sel(part="ecm").values.tolist() == [26, 26]
    assert np.allclose(r["mean"].sel(part="ecm"), 13)
    assert np.allclose(summarize(ds, "stress:effective", ["ecm"]).greatest, 26)
    u = summarize(ds, "displacement:magnitude", ["ecm"])
    assert u["mean"][0, 0] == 0 and u["mean"][0, 1] > 0
    with pytest.raises(InputError, match="xx"):
        summarize(ds, "stress")
    with pytest.raises(InputError, match="pcm"):
        summarize(ds, "stress:xx", ["pcm"])
