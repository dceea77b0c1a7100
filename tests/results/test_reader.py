"""The plotfile reader on files made by hand from the format's rules: versions, byte orders, compression."""

from __future__ import annotations

import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from febkit import results
from febkit.model import InputError
from febkit.results import mesh as meshes
from febkit.results.xplt.reader import PlotFile

HEX = np.array([[0, 4, 6, 2, 1, 5, 7, 3], [4, 8, 10, 6, 5, 9, 11, 7]])


def check(ds: xr.Dataset, version: int) -> None:
    """The content that the hand-made file was given."""
    np.testing.assert_array_equal(ds["time"], [0.0, 0.1, 0.2])
    for t in range(3):
        u = (10 * t + np.arange(36)).reshape(12, 3)
        np.testing.assert_array_equal(ds["displacement"][t], u)
        np.testing.assert_array_equal(ds["effective_fluid_pressure"][t], 100 * t + np.arange(12))
        np.testing.assert_array_equal(ds["stress"][t], 1000 * t + np.arange(12).reshape(2, 6))
    np.testing.assert_array_equal(ds["contact_gap"][1], [[1, 2, 3, 4], [5, 6, 7, 0]])
    np.testing.assert_array_equal(ds["connectivity"], HEX)
    first = 101 if version >= 0x33 else 1
    np.testing.assert_array_equal(ds["node_id"], first + np.arange(12))
    assert ds.attrs["parts"] == ["left", "tissue"]  # the second domain has its material's name
    m = meshes.of(ds)
    np.testing.assert_array_equal(m.node_sets["fix"], [0, 1])
    np.testing.assert_array_equal(m.surfaces["front"], [[0, 4, 5, 1], [4, 8, 9, -1]])
    assert [(b.type, b.part, b.where) for b in m.blocks] == [
        ("hex8", "left", slice(0, 1)), ("hex8", "tissue", slice(1, 2))
    ]


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("version", [8, 0x30, 0x31, 0x32, 0x33, 0x34, 0x35])
def test_versions_and_byte_orders(tmp_path: Path, make_modern, version: int, order: str) -> None:
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern(order, version=version))
    ds = results.open(path)
    check(ds, version)
    assert ds.attrs["febio_version"] == version
    if version >= 0x31:
        assert ds.attrs["unit_system"] == "mm-N-s"
        assert ds["stress"].attrs["units"] == "MPa"
        assert ds["X"].attrs["units"] == "mm"


@pytest.mark.parametrize("flag", [0, 1])
@pytest.mark.parametrize("packed", ["", "body", "block"])
def test_compression_is_found_by_its_bytes(tmp_path: Path, make_modern, flag: int, packed: str) -> None:
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern(compression=flag, packed=packed))
    check(results.open(path), 0x35)


def old_file(b, version: int) -> bytes:
    """Versions below 8: the mesh and the materials lie in the root; coordinates have no ids."""
    wide = 4 + 2 * (version in (2, 3))  # versions 2 and 3 counted two words too many
    header = [b.int(0x01010001, version), b.int(0x01010002, 4)]
    header += [b.int(0x01010003, wide)] if version > 1 else []
    header += [b.int(0x01010004, 0)] if version > 2 else []
    dictionary = b.block(
        0x01020000, b.block(0x01023000, b.item(1, 0, "displacement")), b.block(0x01024000, b.item(0, 1, "J"))
    )
    materials = b.block(0x01030000, b.block(0x01030001, b.int(0x01030002, 1), b.name64(0x01030003, "gel")))
    coords = b.block(0x01041000, b.block(0x01041001, b.floats(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)))
    head = b.block(0x01042101, b.int(0x01042102, 2), b.int(0x01042103, 1), b.int(0x01032104, 1))
    domain = b.block(0x01042100, head, b.block(0x01042200, b.block(0x01042201, b.ints(1, 0, 1, 2, 3))))
    face = b.ints(1, 0, 1, 2, 2) if version == 1 else b.ints(1, 3, 0, 1, 2, -1)
    surface = b.block(
        0x01043100, b.block(0x01043101, b.int(0x01043102, 1), b.int(0x01043103, 1), b.name64(0x01043104, "base")),
        b.block(0x01043200, b.block(0x01043201, face)),
    )
    geometry = b.block(0x01040000, coords, b.block(0x01042000, domain), b.block(0x01043000, surface))
    root = b.block(0x01000000, b.block(0x01010000, *header), dictionary, materials, geometry)
    data = b.block(
        0x02020000, b.block(0x02020300, b.variable(1, (0, b.floats(*range(12))))),
        b.block(0x02020400, b.variable(1, (1, b.floats(1.5)))),
    )
    state = b.block(0x02000000, b.block(0x02010000, b.block(0x02010002, b.floats(2.5))), data)
    return b.magic() + root + state


@pytest.mark.parametrize("version", [1, 2, 4, 5])
def test_old_versions(tmp_path: Path, blocks, version: int) -> None:
    path = tmp_path / "a.xplt"
    path.write_bytes(old_file(blocks, version))
    ds = results.open(path)
    assert ds["time"].item() == 2.5
    assert ds.attrs["parts"] == ["gel"]
    np.testing.assert_array_equal(ds["displacement"][0], np.arange(12).reshape(4, 3))
    assert ds["J"].item() == 1.5
    np.testing.assert_array_equal(ds["X"][3], [0, 0, 1])
    np.testing.assert_array_equal(meshes.of(ds).surfaces["base"][0, :3], [0, 1, 2])


def test_xarray_backend_and_dask(tmp_path: Path, make_modern) -> None:
    from febkit.results.backend import PlotfileBackend

    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern())
    check(xr.open_dataset(path, engine=PlotfileBackend), 0x35)
    lazy = results.open(path, chunks={"time": 1})
    assert lazy["stress"].chunks == ((1, 1, 1), (2,), (6,))
    check(lazy, 0x35)
    assert "stress" not in xr.open_dataset(path, engine=PlotfileBackend, drop_variables="stress")


INDEXERS = [
    {"time": 1}, {"time": [0, 2]}, {"node": 5}, {"node": [1, 3, 3]}, {"node": slice(2, 9, 3)}, {"xyz": 1},
    {"time": 2, "node": [0, 11]}, {"time": [2, 0], "node": [7, 1], "xyz": [2, 0]}, {"time": slice(0, 0)},
    {"node": [4], "xyz": 0}, {"time": [], "node": 3}, {"time": -1, "node": -2, "xyz": -3},
    {"time": slice(None, None, -1)}, {"node": slice(None, None, -2), "xyz": [1, 1]}, {"node": 2, "xyz": [2, 0]},
]


@pytest.mark.parametrize("index", INDEXERS, ids=str)
def test_any_indexing_gives_what_the_whole_array_gives(tmp_path: Path, make_modern, index: dict) -> None:
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern())
    whole = results.open(path)["displacement"].load()
    xr.testing.assert_identical(results.open(path)["displacement"].isel(index).load(), whole.isel(index))


def test_vectorised_indexing(tmp_path: Path, make_modern) -> None:
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern())
    t, n = xr.DataArray([0, 2, 1], dims="pick"), xr.DataArray([3, 0, 11], dims="pick")
    whole = results.open(path)["displacement"].load()
    got = results.open(path)["displacement"].isel(time=t, node=n)
    np.testing.assert_array_equal(got, whole.isel(time=t, node=n))


def test_growing_file(tmp_path: Path, make_modern) -> None:
    path = tmp_path / "a.xplt"
    whole = make_modern(states=5)
    three = len(make_modern(states=3))
    path.write_bytes(whole[: three + 50])
    f = PlotFile(path)
    assert len(f.states) == 3
    assert f.container.leftover == 50
    path.write_bytes(whole)
    assert f.refresh()
    assert len(f.states) == 5
    np.testing.assert_allclose(f.times, 0.1 * np.arange(5), rtol=1e-6)
    assert not f.refresh()


def test_states_of_other_size_in_between(tmp_path: Path, blocks) -> None:
    """Runs of equal states are found in one look; a state without one variable must not shift the rest."""
    b = blocks
    root = b.block(0x01000000, b.block(0x01010000, b.int(0x01010001, 0x35)),
                   b.block(0x01020000, b.block(0x01023000, b.item(0, 0, "a"), b.item(0, 0, "b"))))
    nodes = b.block(0x01041000, b.block(0x01041100, b.int(0x01041101, 1), b.int(0x01041102, 3)),
                    b.block(0x01041200, b.ints(1), b.floats(0, 0, 0)))

    def state(t: int, which: int) -> bytes:
        values = [b.variable(k, (0, b.floats(t))) if k & which else b.variable(k) for k in (1, 2)]
        return b.block(0x02000000, b.block(0x02010000, b.block(0x02010002, b.floats(t))),
                       b.block(0x02020000, b.block(0x02020300, *values)))

    kinds = [3] * 20 + [1, 2, 1] + [3] * 3 + [2] * 17
    path = tmp_path / "a.xplt"
    path.write_bytes(b.magic() + root + b.block(0x01040000, nodes, b.block(0x01042000))
                     + b"".join(state(t, k) for t, k in enumerate(kinds)))
    ds = results.open(path)
    np.testing.assert_array_equal(ds["time"], np.arange(len(kinds)))
    for name, bit in (("a", 1), ("b", 2)):
        want = [t if k & bit else np.nan for t, k in enumerate(kinds)]
        np.testing.assert_array_equal(ds[name][:, 0], want)


def test_mesh_changes_give_one_dataset_each(tmp_path: Path, make_modern) -> None:
    path = tmp_path / "a.xplt"
    raw = make_modern(states=2)
    start = raw.index(struct.pack("<I", 0x01040000), 100)
    end = start + 8 + struct.unpack_from("<I", raw, start + 4)[0]
    path.write_bytes(raw + raw[start:end] + raw[end:])
    with pytest.raises(InputError, match="the mesh changes 1 times"):
        results.open(path)
    first, second = results.open_all(path)
    assert first.sizes["time"] == second.sizes["time"] == 2
    xr.testing.assert_identical(results.open(path, mesh=1).load(), second.load())


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda b: b[:3], "fewer than four bytes"),
        (lambda b: b"PK\3\4" + b[4:], "not an FEBio plotfile"),
        (lambda b: b[:60], "no complete root section"),
        (lambda b: b.replace(struct.pack("<III", 0x01010001, 4, 0x35), struct.pack("<III", 0x01010001, 4, 0x99)),
         "version 0x99"),
        (lambda b: b.replace(struct.pack("<III", 0x01042102, 4, 0), struct.pack("<III", 0x01042102, 4, 77), 1),
         "unknown element type 77"),
        (lambda b: b.replace(struct.pack("<III", 0x01041101, 4, 12), struct.pack("<III", 0x01041101, 4, 13)),
         "13 nodes need"),
        (lambda b: b.replace(struct.pack("<i", 11), struct.pack("<i", 12)), "node that does not exist"),
        (lambda b: b + b"\1\2\3\4\5\6\7\0", "no block of a plotfile"),
    ],
)
def test_damage_is_named(tmp_path: Path, make_modern, spoil, message: str) -> None:
    path = tmp_path / "a.xplt"
    path.write_bytes(spoil(make_modern()))
    with pytest.raises(InputError, match=message):
        results.open(path).load()


def test_values_of_wrong_number_are_named(tmp_path: Path, make_modern) -> None:
    raw = make_modern(states=1)
    at = raw.index(struct.pack("<II", 1, 24), len(raw) - 700)  # stress of domain 1: six floats
    path = tmp_path / "a.xplt"
    path.write_bytes(raw[:at] + struct.pack("<II", 1, 12) + raw[at + 8 : at + 20] + struct.pack("<II", 9, 4)
                     + raw[at + 28 :])
    with pytest.raises(InputError, match="stress"):
        results.open(path)["stress"].load()


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot read the file"):
        results.open(tmp_path / "none.xplt")


def test_reading_does_not_import_numba(tmp_path: Path, make_modern) -> None:
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern())
    code = f"import sys, febkit.results as r; r.open({str(path)!r}).load(); print('numba' in sys.modules)"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "False"


def test_one_variable_at_one_time_touches_nothing_else(tmp_path: Path, make_modern, monkeypatch) -> None:
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern())
    seen: list[tuple[int, int]] = []
    floats = PlotFile.floats
    ds = results.open(path)
    monkeypatch.setattr(PlotFile, "floats", lambda f, v, t: seen.append((v, t)) or floats(f, v, t))
    ds["displacement"].isel(time=1).load()
    assert set(seen) == {(0, 1)}


def test_open_dataset_finds_the_backend(tmp_path: Path, make_modern) -> None:
    """With the entry point installed (here: a stand-in), xr.open_dataset needs no engine."""
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern())
    info = tmp_path / "site" / "standin-0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: standin\nVersion: 0\n")
    (info / "entry_points.txt").write_text("[xarray.backends]\nfebkit = febkit.results.backend:PlotfileBackend\n")
    code = (f"import sys; sys.path.insert(0, {str(tmp_path / 'site')!r}); import xarray as xr;"
            f"ds = xr.open_dataset({str(path)!r}, chunks={{}}); print(ds.sizes['time'], 'numba' in sys.modules)")
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["3", "False"]


@pytest.mark.parametrize("chunks", [None, {"time": 1}])
def test_lazy_datasets_travel(tmp_path: Path, make_modern, chunks) -> None:
    """A dataset that is not loaded can be pickled, as dask's workers need it."""
    import pickle

    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern())
    ds = results.open(path, chunks=chunks)
    sent = pickle.dumps(ds)
    check(pickle.loads(sent), 0x35)
    if chunks:
        whole = results.open(path)["stress"].mean().item()
        assert ds["stress"].mean().compute(scheduler="threads").item() == pytest.approx(whole)
