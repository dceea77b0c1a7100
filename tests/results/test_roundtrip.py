"""Round trips: random plotfiles to datasets, NetCDF and plotfiles again, equal in values and in bytes."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from febkit import results
from febkit.results.xplt.reader import PlotFile

QUICK = settings(
    max_examples=int(os.environ.get("FEBKIT_EXAMPLES", "6")), deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


@given(seed=st.integers(0, 2**32 - 1), compress=st.booleans(), states=st.integers(0, 4),
       version=st.sampled_from([0x30, 0x31, 0x32, 0x33, 0x34, 0x35]))
@QUICK
def test_what_is_written_is_read(tmp_path_factory, random_plot, seed, compress, states, version) -> None:
    path = tmp_path_factory.mktemp("plot") / "a.xplt"
    mesh, variables, data = random_plot(path, seed, states, compress=compress, version=version, units="SI")
    with PlotFile(path) as f:
        # the dictionary goes by section
        assert f.variables == [v for s in ("global", "node", "domain", "surface") for v in variables if v.section == s]
        assert [float(t) for t in f.times] == [0.25 * t for t in range(states)]
        assert f.statuses.tolist() == [t % 3 if version >= 0x31 else 0 for t in range(states)]
        back = f.mesh()
        np.testing.assert_array_equal(back.X, mesh.X)
        if version >= 0x33:
            np.testing.assert_array_equal(back.node_ids, mesh.node_ids)
        assert back.parts == mesh.parts
        for d, e in zip(back.domains, mesh.domains, strict=True):
            assert (d.type, d.part_id, d.name) == (e.type, e.part_id, e.name)
            np.testing.assert_array_equal(d.conn, e.conn)
            np.testing.assert_array_equal(d.element_ids, e.element_ids)
        for s, t in zip(back.surfaces, mesh.surfaces, strict=True):
            assert s.name == t.name
            np.testing.assert_array_equal(s.rows(), t.rows())
        assert {k: v.tolist() for k, v in back.node_sets.items()} == {
            k: np.asarray(v).tolist() for k, v in mesh.node_sets.items()
        }
        assert list(back.element_sets) == (list(mesh.element_sets) if version >= 0x32 else [])
        for t in range(states):
            for i, v in enumerate(f.variables):
                found = dict(f.regions(i, t))
                assert list(found) == list(data[t][v.name])
                for region, values in found.items():
                    np.testing.assert_array_equal(values, data[t][v.name][region].ravel())


@given(seed=st.integers(0, 2**32 - 1), compress=st.booleans())
@QUICK
def test_rewriting_gives_the_same_bytes(tmp_path_factory, random_plot, seed, compress) -> None:
    folder = tmp_path_factory.mktemp("plot")
    a, b, c, d = (folder / f"{n}.xplt" for n in "abcd")
    random_plot(a, seed, 3, compress=compress, units="SI")
    results.copy(a, b)
    assert b.read_bytes() == a.read_bytes()
    with results.open(a, apart=True) as ds:
        results.write(ds, c)
        results.write(ds, folder / "a.nc")
    assert c.read_bytes() == a.read_bytes()
    with results.open(folder / "a.nc") as ds:
        results.write(ds, d)
    assert d.read_bytes() == a.read_bytes()


@given(seed=st.integers(0, 2**32 - 1), apart=st.booleans())
@QUICK
def test_netcdf_and_back(tmp_path_factory, random_plot, seed, apart) -> None:
    folder = tmp_path_factory.mktemp("plot")
    random_plot(folder / "a.xplt", seed, 2, some=30)
    with results.open(folder / "a.xplt", apart=apart) as ds:
        results.write(ds, folder / "a.nc", compress=1)
        with results.open(folder / "a.nc") as back:
            xr.testing.assert_identical(ds.load(), back.load())
            assert {k: type(v) for k, v in ds.attrs.items()} | {"febio_version": 0, "febio_compression": 0} == {
                k: type(v) for k, v in back.attrs.items()
            } | {"febio_version": 0, "febio_compression": 0}


def test_compressing_and_back(tmp_path: Path, random_plot) -> None:
    random_plot(tmp_path / "a.xplt", 5, 4)
    results.copy(tmp_path / "a.xplt", tmp_path / "b.xplt", compress=True)
    assert (tmp_path / "b.xplt").stat().st_size < (tmp_path / "a.xplt").stat().st_size
    results.copy(tmp_path / "b.xplt", tmp_path / "c.xplt", compress=False)
    assert (tmp_path / "c.xplt").read_bytes() == (tmp_path / "a.xplt").read_bytes()


def test_shared_nodes_keep_their_two_values(tmp_path: Path, make_modern) -> None:
    """Nodal values of domains may jump at shared nodes: apart keeps both."""
    import struct

    raw = bytearray(make_modern(states=1))
    at = raw.index(struct.pack("<II", 2, 32) + struct.pack("<f", 4.0))  # pressures of the second domain
    raw[at + 8 : at + 12] = struct.pack("<f", -5.0)
    path = tmp_path / "a.xplt"
    path.write_bytes(bytes(raw))
    apart = results.open(path, apart=True)
    values, nodes = apart["effective_fluid_pressure"][0].values, apart["domain_node_index"].values
    assert sorted(values[nodes == 4]) == [-5.0, 4.0]
    assert results.open(path)["effective_fluid_pressure"][0, 4] == -5.0


def test_new_variables_are_stored(tmp_path: Path, make_modern) -> None:
    (tmp_path / "a.xplt").write_bytes(make_modern())
    ds = results.open(tmp_path / "a.xplt").load()
    ds = ds.drop_vars([n for n in ds.data_vars if n != "displacement"]).assign(
        speed=(("time", "node"), np.ones((3, 12), np.float32)),
        F=(("time", "element", "tensor"), np.tile(np.eye(3, dtype=np.float32).ravel(), (3, 2, 1))),
        odd=(("time", "something"), np.zeros((3, 5))),
    )
    with pytest.warns(UserWarning, match="cannot hold odd"):
        results.write(ds, tmp_path / "b.xplt")
    back = results.open(tmp_path / "b.xplt")
    np.testing.assert_array_equal(back["speed"], ds["speed"])
    np.testing.assert_array_equal(back["F"], ds["F"])
    assert back["F"].dims == ("time", "element", "tensor")
