"""LS-DYNA databases of FEBio 1, made word by word."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from febkit import results
from febkit.model import InputError
from febkit.results import mesh as meshes
from febkit.results.plt import open_plt

X = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
HEX = [1, 2, 3, 4, 5, 6, 7, 8, 1]
TET = [1, 2, 3, 3, 5, 5, 5, 5, 2]
WEDGE = [5, 2, 1, 4, 6, 6, 3, 3, 1]  # FEBio Studio's order of a degenerate hexahedron
SHELL = [1, 2, 3, 3, 2]


def header(order: str, **counts: int) -> bytes:
    words = [0] * 64
    at = {"ndim": 15, "nodes": 16, "icode": 17, "globals": 18, "T": 19, "U": 20, "V": 21, "A": 22, "solids": 23,
          "nv3d": 27, "beams": 28, "nv1d": 30, "shells": 31, "nv2d": 33, "neips": 35}
    for k, v in ({"ndim": 4, "icode": 6, "neips": 2000} | counts).items():
        words[at[k]] = v
    raw = struct.pack(f"{order}64i", *words)
    return b"two solids and a shell".ljust(40, b"\0") + raw[40:]


def database(order: str = "<", states: int = 3) -> tuple[bytes, list[bytes]]:
    """Header and mesh; records of the states."""
    head = header(order, nodes=8, T=1, U=1, V=0, A=1, solids=3, nv3d=7, shells=1, nv2d=32, nv1d=6)
    mesh = struct.pack(f"{order}24f", *X.ravel())
    mesh += struct.pack(f"{order}27i", *HEX, *TET, *WEDGE) + struct.pack(f"{order}5i", *SHELL)
    records = []
    for t in range(states):
        a = np.arange(8 * 3).reshape(8, 3) + 100 * t
        stress = np.arange(21).reshape(3, 7) + 1000 * t
        shell = np.arange(32) + 0.5
        values = [0.1 * t, *(X + 0.25 * t).ravel(), *a.ravel(), *(np.arange(8) - t), *stress.ravel(), *shell]
        records.append(struct.pack(f"{order}{len(values)}f", *values))
    return head + mesh, records


def check(ds, states: int = 3) -> None:
    np.testing.assert_array_equal(ds["time"], [0.0, 0.1, 0.2][:states])
    assert ds.attrs["title"] == "two solids and a shell"
    for t in range(states):
        np.testing.assert_array_equal(ds["displacement"][t], np.full((8, 3), 0.25 * t))
        np.testing.assert_array_equal(ds["acceleration"][t], np.arange(24).reshape(8, 3) + 100 * t)
        np.testing.assert_array_equal(ds["temperature"][t], np.arange(8) - t)
        np.testing.assert_array_equal(ds["stress"][t, :3], np.arange(21).reshape(3, 7)[:, :6] + 1000 * t)
        np.testing.assert_array_equal(ds["stress"][t, 3], np.arange(6) + 0.5)
        np.testing.assert_array_equal(ds["plastic_strain"][t], [6 + 1000 * t, 13 + 1000 * t, 20 + 1000 * t, 6.5])
        np.testing.assert_array_equal(ds["shell_thickness"][t], [np.nan] * 3 + [29.5])
    found = [(b.type, b.part, b.conn.tolist()) for b in meshes.of(ds).blocks]
    assert found == [
        ("hex8", "material1", [[0, 1, 2, 3, 4, 5, 6, 7]]),
        ("tet4", "material2", [[0, 1, 2, 4]]),
        ("penta6", "material1", [[5, 1, 4, 2, 0, 3]]),
        ("tri3", "material2", [[0, 1, 2]]),
    ]


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("end", [True, False])
def test_database(tmp_path: Path, order: str, end: bool) -> None:
    mesh, records = database(order)
    tail = struct.pack(order + "f", -999999.0) + bytes(len(records[0]) - 4) if end else b""
    (tmp_path / "a.plt").write_bytes(mesh + b"".join(records) + tail)
    check(results.open(tmp_path / "a.plt"))


def test_family_of_files(tmp_path: Path) -> None:
    mesh, records = database()
    (tmp_path / "a.plt").write_bytes(mesh + records[0])
    (tmp_path / "a.plt01").write_bytes(records[1])
    (tmp_path / "a.plt02").write_bytes(records[2] + records[0][:40])
    check(results.open(tmp_path / "a.plt"))


def test_slots_of_poroelastic_runs(tmp_path: Path) -> None:
    mesh, records = database()
    (tmp_path / "a.plt").write_bytes(mesh + b"".join(records))
    ds = open_plt(tmp_path / "a.plt", {"acceleration": "fluid_flux", "temperature": "fluid_pressure"})
    np.testing.assert_array_equal(ds["fluid_pressure"][1], np.arange(8) - 1)
    assert ds["fluid_flux"].attrs["febio_name"] == "fluid flux"


def test_to_a_plotfile(tmp_path: Path) -> None:
    mesh, records = database()
    (tmp_path / "a.plt").write_bytes(mesh + b"".join(records))
    ds = results.open(tmp_path / "a.plt")
    results.write(ds, tmp_path / "a.xplt")
    back = results.open(tmp_path / "a.xplt")
    np.testing.assert_array_equal(back["stress"], ds["stress"])
    np.testing.assert_array_equal(back["displacement"], ds["displacement"])
    assert [b.type for b in meshes.of(back).blocks] == ["hex8", "tet4", "penta6", "tri3"]


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (b"", "not an LS-DYNA state database"),
        (bytes(400), "not an LS-DYNA state database"),
        (database()[0][:300], "ends within its mesh"),
        (header("<", nodes=-5), "nodes is -5"),
        (database()[0].replace(struct.pack("<9i", *TET), struct.pack("<9i", *TET[:7], 99, 2)), "does not exist"),
    ],
)
def test_damage_is_named(tmp_path: Path, raw: bytes, message: str) -> None:
    (tmp_path / "a.plt").write_bytes(raw)
    with pytest.raises(InputError, match=message):
        results.open(tmp_path / "a.plt")


def test_mutated_databases(tmp_path: Path) -> None:
    mesh, records = database()
    raw = mesh + b"".join(records)
    rng = np.random.default_rng(7)
    seen = {"error": 0, "read": 0}
    for _ in range(200):
        data = bytearray(raw)
        at = int(rng.integers(60, 300) // 4 * 4)
        data[at : at + 4] = struct.pack("<i", int(rng.choice([-1, 0, 3, 1 << 30, 0x7FFFFFFF])))
        (tmp_path / "a.plt").write_bytes(data[: rng.integers(250, len(data))])
        try:
            results.open(tmp_path / "a.plt").load()
            seen["read"] += 1
        except InputError:
            seen["error"] += 1
    assert min(seen.values()) > 10


def test_a_database_rewritten_while_it_is_open(tmp_path: Path) -> None:
    import pickle

    mesh, records = database()
    path = tmp_path / "a.plt"
    path.write_bytes(mesh + b"".join(records))
    ds = results.open(path)
    sent = pickle.loads(pickle.dumps(ds["displacement"].variable._data))
    assert (np.asarray(sent) == ds["displacement"].values).all()
    path.write_bytes(mesh + b"".join(reversed(records)))
    with pytest.raises(InputError, match="written anew"):
        _ = ds["displacement"].values
    path.write_bytes(mesh)
    with pytest.raises(InputError, match="shorter"):
        _ = ds["displacement"].values
