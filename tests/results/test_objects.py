"""Objects of a plotfile: rigid bodies, connectors, springs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from febkit import results
from febkit.model import InputError
from febkit.results.objects import objects
from febkit.results.xplt.objects import ObjectState, PlotObject, read_section, read_state, section, state
from febkit.results.xplt.records import PlotDomain, PlotMesh, PlotVariable
from febkit.results.xplt.writer import PlotWriter

FORCE = PlotVariable("Force", "object", "vec3f", "item")
SWING = PlotVariable("Swing (deg)", "object", "float", "item")
BODIES = [
    PlotObject("plate", 1, 1, data=(FORCE,)),
    PlotObject("joint", 2, 3, data=(SWING, FORCE)),
    PlotObject("spring", 1, 7, line=True, ends=(0, 0, 0, 1, 0, 0), data=(SWING,)),
]


def states(t: float) -> dict[str, ObjectState]:
    return {
        "plate": ObjectState((t, 0, 0), values={0: (1 + t, 2, 3)}),
        "joint": ObjectState((0, t, 0), (1, 0, 0, 0), values={0: 5 + t, 1: (4, 5, 6)}),
        "spring": ObjectState((0, 0, 0), coordinates=(0, 0, 0, 1, t, 0), values={0: 9.0}),
    }


def test_bytes_of_a_rigid_body(blocks) -> None:
    b = blocks
    item = (b.int(0x01020002, 1), b.int(0x01020003, 1), b.int(0x01020005, 0), b.name64(0x01020004, "Force"))
    want = b.block(0x01051000, b.int(0x01050001, 1), b.text(0x01050002, "plate"), b.int(0x01050003, 1),
                   b.block(0x01050004, b.floats(0, 0, 0)), b.block(0x01050005, b.floats(0, 0, 0, 1)),
                   b.block(0x01050006, *item))
    assert section(BODIES[:1]) == want
    now = b.block(0x01051000, b.int(0x01050001, 1), b.block(0x01050004, b.floats(2, 0, 0)),
                  b.block(0x01050005, b.floats(0, 0, 0, 1)), b.block(0x01051001, b.floats(2, 0, 0)),
                  b.block(0x01050006, b.block(0, b.floats(3, 2, 3))))
    assert state(BODIES[:1], states(2.0)) == now


def test_objects_over_time_and_rewriting(tmp_path: Path) -> None:
    mesh = PlotMesh(np.array([1, 2]), np.eye(3)[:2],
                    [PlotDomain("line2", 1, None, np.array([1]), np.array([[0, 1]]))], objects=section(BODIES))
    with PlotWriter(tmp_path / "a.xplt", mesh, []) as w:
        for t in (0.0, 0.5):
            w.state(t, {}, objects=state(BODIES, states(t)))
    ds = results.open(tmp_path / "a.xplt")
    found = objects(ds)
    assert found["object"].values.tolist() == ["plate", "joint", "spring"]
    np.testing.assert_array_equal(found["position"][1], [[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0]])
    np.testing.assert_array_equal(found["Force"].sel(object="plate"), [[1, 2, 3], [1.5, 2, 3]])
    np.testing.assert_array_equal(found["Force"].sel(object="spring"), np.full((2, 3), np.nan))
    np.testing.assert_array_equal(found["Swing_deg"], [[np.nan, 5, 9], [np.nan, 5.5, 9]])
    results.write(ds, tmp_path / "b.xplt")
    assert (tmp_path / "b.xplt").read_bytes() == (tmp_path / "a.xplt").read_bytes()


def test_a_run_without_objects_has_none(tmp_path: Path, make_modern) -> None:
    (tmp_path / "a.xplt").write_bytes(make_modern())
    assert not objects(results.open(tmp_path / "a.xplt")).sizes


def test_damaged_objects_are_refused() -> None:
    raw, now = section(BODIES), state(BODIES, states(1))
    rng = np.random.default_rng(4)
    refused = 0
    for _ in range(300):
        for read, source in ((read_section, raw), (read_state, now)):
            data = bytearray(source)
            data[int(rng.integers(len(data)))] = int(rng.integers(256))
            try:
                read(bytes(data[: int(rng.integers(len(data) + 1))]))
            except InputError:
                refused += 1
    assert refused > 100
    with pytest.raises(InputError, match="stray bytes"):
        read_section(raw[:-1])
