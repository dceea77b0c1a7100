"""Picked elements of one state are read as the whole array would give them."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import febkit.results


@pytest.fixture
def plot(tmp_path):
    """Two parts of two hexahedra; a variable that one part has not, values at nodes of elements."""
    rng = np.random.default_rng(0)
    X = np.stack(np.meshgrid([0.0, 1], [0.0, 1], np.arange(5.0), indexing="ij"), -1).reshape(-1, 3)
    first = np.array([0, 10, 15, 5, 1, 11, 16, 6])
    conn = first + np.arange(4)[:, None]
    half = rng.random((2, 4)).astype(np.float32)
    half[:, :2] = np.nan
    data = {
        "displacement": (("time", "node", "xyz"), rng.random((2, 20, 3)).astype(np.float32)),
        "stress": (("time", "element", "voigt"), rng.random((2, 4, 6)).astype(np.float32)),
        "nodal_fluid_flux": (("time", "element", "local", "xyz"), rng.random((2, 4, 8, 3)).astype(np.float32)),
        "relative_volume": (("time", "element"), half),
    }
    coords = {
        "time": [0.0, 1.0], "xyz": ["x", "y", "z"], "voigt": ["xx", "yy", "zz", "xy", "yz", "xz"],
        "X": (("node", "xyz"), X), "node_id": ("node", np.arange(20) + 1),
        "element_id": ("element", np.arange(4) + 1), "part": ("element", np.array([0, 0, 1, 1])),
        "element_type": ("element", np.zeros(4, int)), "connectivity": (("element", "local"), conn),
    }
    ds = xr.Dataset(data, coords, {"parts": ["ecm", "cell1"], "element_types": ["hex8"]})
    febkit.results.write(ds, tmp_path / "run.xplt")
    return febkit.results.open(tmp_path / "run.xplt")


@pytest.mark.parametrize("name", ["displacement", "stress", "nodal_fluid_flux", "relative_volume"])
@pytest.mark.parametrize("rows", [[0], [3, 0, 2], [1, 1], [-1], [False, True, True, False], []])
def test_rows_are_those_of_the_whole_array(plot, name, rows):
    dim = plot[name].dims[1]
    if dim == "node" and rows and isinstance(rows[0], bool):
        rows = rows * 5
    rows = np.array(rows, dtype=None if rows else int)
    whole = plot[name].isel(time=1).values
    assert np.isfinite(whole).any()
    assert np.array_equal(plot[name].isel({"time": 1, dim: rows}).values, whole[rows], equal_nan=True)
