"""The plotfile writer against the format's rules and an independent reader."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from febkit.results.variables import VARIABLES
from febkit.results.xplt.reader import PlotFile
from febkit.results.xplt.records import PlotDomain, PlotMesh, PlotSurface, PlotVariable
from febkit.results.xplt.writer import PlotWriter

X = np.array([[x, y, z] for x in (0, 1, 2) for y in (0, 1) for z in (0, 1)], float)
HEX = np.array([[0, 4, 6, 2, 1, 5, 7, 3], [4, 8, 10, 6, 5, 9, 11, 7]])


def two_hexes() -> PlotMesh:
    return PlotMesh(
        np.arange(1, 13), X,
        [PlotDomain("hex8", 1, "left", np.array([1]), HEX[:1]), PlotDomain("hex8", 2, "right", np.array([2]), HEX[1:])],
        surfaces=[PlotSurface("front", {"quad4": [[0, 4, 5, 1]], "tri3": [[4, 8, 9]]})],
        node_sets={"fix": [0, 1]}, element_sets={"all": [1, 2]}, parts=[(1, "soft"), (2, "stiff")],
    )


def test_whole_file_byte_by_byte(tmp_path: Path, blocks) -> None:
    b = blocks
    mesh = PlotMesh(np.array([7, 9]), np.array([[0, 0, 0], [1, 2, 3]]),
                    [PlotDomain("line2", 1, None, np.array([5]), np.array([[0, 1]]))], parts=[(1, "spring")])
    with PlotWriter(tmp_path / "a.xplt", mesh, [VARIABLES["displacement"]], software="FEBio 4.11.0",
                    units="SI") as w:
        w.state(0.5, {"displacement": np.arange(6.0)})
    item = b.block(0x01020001, b.int(0x01020002, 1), b.int(0x01020003, 0), b.int(0x01020005, 0),
                   b.name64(0x01020004, "displacement"), b.name64(0x01020007, "L"))
    root = b.block(
        0x01000000,
        b.block(0x01010000, b.int(0x01010001, 0x35), b.int(0x01010004, 0), b.text(0x01010006, "FEBio 4.11.0"),
                b.text(0x01010007, "SI")),
        b.block(0x01020000, b.block(0x01023000, item)),
    )
    nodes = b.block(
        0x01041000, b.block(0x01041100, b.int(0x01041101, 2), b.int(0x01041102, 3)),
        b.block(0x01041200, b.ints(7), b.floats(0, 0, 0), b.ints(9), b.floats(1, 2, 3)),
    )
    head = b.block(0x01042101, b.int(0x01042102, 5), b.int(0x01042103, 1), b.int(0x01032104, 1))
    domain = b.block(0x01042100, head, b.block(0x01042200, b.block(0x01042201, b.ints(5, 0, 1))))
    part = b.block(0x01045000, b.block(0x01045100, b.int(0x01045101, 1), b.name64(0x01045102, "spring")))
    mesh_bytes = b.block(0x01040000, nodes, b.block(0x01042000, domain), part)
    state = b.block(
        0x02000000,
        b.block(0x02010000, b.block(0x02010002, b.floats(0.5)), b.int(0x02010003, 0)),
        b.block(0x02030000, b.block(0x02030001, b.ints(1))),
        b.block(0x02020000, b.block(0x02020300, b.variable(1, (0, b.floats(*range(6)))))),
    )
    assert (tmp_path / "a.xplt").read_bytes() == b.magic() + root + mesh_bytes + state


def test_independent_reader_agrees(tmp_path: Path, reference) -> None:
    names = ("displacement", "effective fluid pressure", "stress", "nodal fluid flux")
    rng = np.random.default_rng(3)
    u, p, s = rng.random((12, 3)), rng.random(12), rng.random((2, 6))
    flux = {1: rng.random((8, 3)), 2: rng.random((8, 3))}
    with PlotWriter(tmp_path / "a.xplt", two_hexes(), [VARIABLES[n] for n in names]) as w:
        for t in (0.0, 0.5):
            w.state(t, dict(zip(names, (u + t, p + t, s + t, flux))))
    x = reference(str(tmp_path / "a.xplt"))
    assert x.version == 0x35
    assert x.times == [0.0, 0.5]
    np.testing.assert_array_equal(x.node_ids, np.arange(1, 13))
    assert [d["name"] for d in x.domains] == ["left", "right"]
    np.testing.assert_allclose(x.get("displacement")[0][0], u + 0.5, rtol=1e-6)
    for k in (0, 1):
        first_seen = list(dict.fromkeys(HEX[k].tolist()))
        np.testing.assert_allclose(x.get("effective fluid pressure")[0][k + 1][:, 0], p[first_seen] + 0.5, rtol=1e-6)
        np.testing.assert_allclose(x.get("stress")[0][k + 1][0], s[k] + 0.5, rtol=1e-6)
        np.testing.assert_allclose(x.get("nodal fluid flux", 0)[0][k + 1], flux[k + 1], rtol=1e-6)


def test_facets_are_padded_to_the_widest(tmp_path: Path) -> None:
    v = PlotVariable("contact gap", "surface", "float", "mult")
    with PlotWriter(tmp_path / "a.xplt", two_hexes(), [v]) as w:
        w.state(0, {"contact gap": {1: np.arange(1.0, 7).reshape(2, 3)}})
    with PlotFile(tmp_path / "a.xplt") as f:
        (_, values), = f.regions(0, 0)
        np.testing.assert_array_equal(values, [1, 2, 3, 0, 4, 5, 6, 0])


@pytest.mark.parametrize("compress", [False, True])
def test_complete_states_survive_an_interruption(tmp_path: Path, compress: bool) -> None:
    path = tmp_path / "a.xplt"
    w = PlotWriter(path, two_hexes(), [VARIABLES["displacement"]], compress=compress)
    sizes = [w.output.size]
    assert not path.exists(), "nothing stands there before the first state"
    for t in range(4):
        w.state(t, {"displacement": np.full((12, 3), t)})
        sizes.append(path.stat().st_size)
    w.close()
    whole = path.read_bytes()
    for cut in range(sizes[0], len(whole) + 1, 7):
        path.write_bytes(whole[:cut])
        with PlotFile(path) as f:
            assert len(f.states) == sum(s <= cut for s in sizes[1:])
            assert f.container.truncated == (cut not in sizes)


def test_mesh_change(tmp_path: Path) -> None:
    first = two_hexes()
    second = PlotMesh(first.node_ids[:8], X[:8], first.domains[:1], parts=first.parts)
    with PlotWriter(tmp_path / "a.xplt", first, [VARIABLES["displacement"]], compress=True) as w:
        w.state(0, {"displacement": np.zeros((12, 3))})
        w.mesh(second)
        w.state(1, {"displacement": np.ones((8, 3))}, status=1)
    with PlotFile(tmp_path / "a.xplt") as f:
        assert [s.mesh for s in f.states] == [0, 1]
        assert len(f.mesh(1).node_ids) == 8
        assert f.statuses.tolist() == [0, 1]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"stress": {1: np.zeros(6)}}, "not in the plotfile's dictionary"),
        ({"displacement": np.zeros((11, 3))}, "33 values where 36 belong"),
        ({"relative volume": {3: np.zeros(1)}}, "no domain 3"),
    ],
)
def test_wrong_data_are_refused_and_leave_the_file_whole(tmp_path: Path, data: dict, message: str) -> None:
    path = tmp_path / "a.xplt"
    with PlotWriter(path, two_hexes(), [VARIABLES["displacement"], VARIABLES["relative volume"]]) as w:
        before = w.output.size
        with pytest.raises(ValueError, match=message):
            w.state(0, data)
        assert w.output.size == before
        w.state(0, {})
    with PlotFile(path) as f:
        assert len(f.states) == 1


def test_old_versions_are_not_written(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="0x30 to 0x35"):
        PlotWriter(tmp_path / "a.xplt", two_hexes(), [], version=8)


def test_writer_needs_numpy_only() -> None:
    code = ("import sys, febkit.results.xplt.writer, febkit.results.variables;"
            "print([m for m in ('xarray', 'numba', 'scipy', 'meshio', 'pandas', 'lxml') if m in sys.modules])")
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"


def test_table_of_variables_matches_the_usual_storage() -> None:
    usual = {
        "displacement": ("node", "vec3f", "node"), "effective fluid pressure": ("domain", "float", "node"),
        "fluid pressure": ("domain", "float", "item"), "fluid flux": ("domain", "vec3f", "item"),
        "nodal fluid flux": ("domain", "vec3f", "mult"), "stress": ("domain", "mat3fs", "item"),
        "relative volume": ("domain", "float", "item"), "reaction forces": ("node", "vec3f", "node"),
    }
    for name, storage in usual.items():
        v = VARIABLES[name]
        assert (v.section, v.type, v.format) == storage
