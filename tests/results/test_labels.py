"""Nodes and elements are labelled by the file's ids, and codes say what they mean."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from febkit import results


@pytest.mark.parametrize("version", [0x31, 0x33, 0x35])
def test_nodes_and_elements_by_id(tmp_path: Path, make_modern, version: int) -> None:
    """Ids stand in files since version 0x33 and count from 1 before."""
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern(version=version))
    ds = results.open(path)
    first = 101 if version >= 0x33 else 1
    for k in (0, 7, 11):
        np.testing.assert_array_equal(ds["displacement"].sel(node=first + k), ds["displacement"].isel(node=k))
    np.testing.assert_array_equal(ds["stress"].sel(element=2), ds["stress"].isel(element=1))
    with pytest.raises(KeyError):
        ds.sel(node=first + 12)
    some = ds.sel(node=[first + 3, first], time=0.1)
    np.testing.assert_array_equal(some["displacement"], ds["displacement"].values[1][[3, 0]])
    np.testing.assert_array_equal(ds["node"], ds["node_id"])
    np.testing.assert_array_equal(ds["element"], ds["element_id"])


def test_ids_in_any_order(tmp_path: Path, random_plot) -> None:
    mesh, _, data = random_plot(tmp_path / "a.xplt", 4, 2)
    ids = np.asarray(mesh.node_ids)
    assert not (np.diff(ids) == 1).all()
    for ds in (results.open(tmp_path / "a.xplt"), results.open(tmp_path / "a.xplt", chunks={"time": 1})):
        for k in (0, 17, 39):
            got = ds["node_node_vec3f"].isel(time=1).sel(node=int(ids[k]))
            np.testing.assert_array_equal(got, data[1]["node node vec3f"][0][k])
        e = mesh.element_ids()
        np.testing.assert_array_equal(ds["part"].sel(element=int(e[-1])), len(mesh.domains) - 1)


def test_two_runs_meet_by_id(tmp_path: Path, make_modern) -> None:
    """Differences are those of the same nodes, also where one dataset holds them in another order."""
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern())
    ds = results.open(path).load()
    other = ds.isel(node=slice(None, None, -1))
    assert float(np.abs(ds["displacement"] - other.reindex_like(ds)["displacement"]).max()) == 0


def test_codes_say_what_they_mean(tmp_path: Path, make_modern) -> None:
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern())
    results.write(results.open(path), tmp_path / "a.nc")
    for ds in (results.open(path), results.open(tmp_path / "a.nc")):
        for name, words in (("part", "left tissue"), ("element_type", "hex8"),
                            ("state_status", "converged new_mesh not_converged")):  # fmt: skip
            assert ds[name].attrs["flag_meanings"] == words
            assert ds[name].attrs["flag_values"] == list(range(len(words.split())))
        assert ds["element_state"].attrs["flag_masks"] == [1]
    xr.testing.assert_identical(results.open(path).load(), results.open(tmp_path / "a.nc").load())
