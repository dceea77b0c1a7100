"""Damaged plotfiles: a clear error, a right reading, or one with a warning, in bounded time and memory; nothing else.

FEBKIT_MUTATIONS sets how many of each kind, FEBKIT_SEED the seed.
"""

from __future__ import annotations

import os
import struct
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from febkit import results
from febkit.model import InputError
from febkit.results.difference import difference
from febkit.results.objects import objects
from febkit.results.summary import summarize
from febkit.results.xplt.objects import ObjectState, PlotObject, section, state
from febkit.results.xplt.records import PlotVariable
from febkit.results.xplt.writer import PlotWriter
from helpers import memory, mutate_plot
from helpers.mutants import TooLong, watchdog

COUNT = int(os.environ.get("FEBKIT_MUTATIONS", "100"))  # per kind of file
SEED = int(os.environ.get("FEBKIT_SEED", "2024"))
LONGEST = 5  # seconds


def exercise(path: Path, good: Path) -> str:
    """Everything that can be done with a plotfile; what came of it."""
    told = "read"
    steps: tuple[Callable[[], object], ...] = (
        lambda: [_loaded(ds, path) for ds in results.open_all(path)],
        lambda: summarize(path, every=True),
        lambda: results.copy(path, path.with_suffix(".copy.xplt")),
        lambda: [ds.load() for ds in results.open_all(path.with_suffix(".copy.xplt"))],
        lambda: difference(good, path),
    )
    for step in steps:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            try:
                step()
            except InputError as e:
                assert str(e)
                return "refused"
        assert not any(issubclass(w.category, RuntimeWarning) for w in said), [str(w.message) for w in said]
        told = "warned" if said and told == "read" else told
    return told


def _loaded(ds, path: Path) -> None:
    ds.load()
    objects(ds)
    assert ds.sizes["node"] == ds["X"].shape[0]
    ds.close()


def sources(tmp_path: Path, make_modern, random_plot) -> list[tuple[bytes, str]]:
    """Plain plotfiles and their byte orders: by hand, of every kind of variable, with objects and two meshes."""
    out = [(make_modern(), "<"), (make_modern(">"), ">"), (make_modern(version=0x31), "<")]
    path = tmp_path / "source.xplt"
    random_plot(path, 1, 2, some=12)
    out.append((path.read_bytes(), "<"))
    mesh, variables, data = random_plot(path, 2, 2, some=5)
    body = PlotObject("plate", 1, data=[PlotVariable("Force", "object", "vec3f", "item")])
    from dataclasses import replace

    mesh = replace(mesh, objects=section([body]))
    with PlotWriter(path, mesh, variables, units="SI") as w:
        for t in range(3):
            if t == 2:
                w.mesh(mesh)
            s = ObjectState(np.zeros(3), values={0: np.ones(3)})
            w.state(float(t), data[t % 2], objects=state([body], {"plate": s}))
    out.append((path.read_bytes(), "<"))
    return out


@pytest.mark.parametrize("packed", ["", "block", "body"])
@pytest.mark.parametrize("way", ["raw", "deep"])
def test_damaged_files(tmp_path: Path, make_modern, random_plot, way: str, packed: str) -> None:
    plain = sources(tmp_path, make_modern, random_plot)
    rng = np.random.default_rng([SEED, len(way), len(packed)])
    path, good = tmp_path / "a.xplt", tmp_path / "good.xplt"
    good.write_bytes(plain[0][0])
    seen: Counter[str] = Counter()
    slowest, before = 0.0, memory.begin()
    for k in range(COUNT):
        raw, order = plain[int(rng.integers(len(plain)))]
        if way == "deep":
            path.write_bytes(mutate_plot.deep(rng, raw, order, packed))
        else:
            path.write_bytes(mutate_plot.raw(rng, _packed(raw, order, packed)))
        start = time.process_time()
        try:
            with watchdog(LONGEST):
                seen[exercise(path, good)] += 1
        except (Exception, TooLong):
            kept = Path(os.environ.get("FEBKIT_KEEP", str(tmp_path))) / f"bad_{way}_{packed}_{k}.xplt"
            kept.write_bytes(path.read_bytes())
            (kept.with_suffix(".txt")).write_text(traceback.format_exc())
            seen["wrong"] += 1
        slowest = max(slowest, time.process_time() - start)
    more = memory.peak() - before  # kB
    print(way, packed, dict(seen), f"slowest {slowest:.2f} s, {more // 1000} MB")
    assert not seen["wrong"], sorted(tmp_path.glob("bad_*.txt"))[0].read_text()
    assert slowest < LONGEST
    assert more < 1_000_000
    assert seen["refused"] > COUNT // 20 and seen["read"] + seen["warned"] > COUNT // 20, seen


def _packed(raw: bytes, order: str, packed: str) -> bytes:
    if not packed:
        return raw
    top = mutate_plot.parse(raw, order)
    for n in top:
        if n.tag == 0x02000000:
            n.packed = packed
    return raw[:4] + b"".join(n.bytes(order) for n in top)


def test_a_bomb_is_bounded_by_its_size(tmp_path: Path, make_modern) -> None:
    """A compressed state that would inflate to 200 MB is counted piece by piece and refused."""
    import zlib

    plain = make_modern(states=0)
    bomb = struct.pack("<II", 0x02000000, 10) + bytes(200_000_000)
    (tmp_path / "a.xplt").write_bytes(plain + zlib.compress(bomb, 9))
    del bomb
    before = memory.begin()
    with pytest.raises(InputError, match="compressed data is no state"):
        results.open(tmp_path / "a.xplt")
    assert memory.peak() - before < 50_000
