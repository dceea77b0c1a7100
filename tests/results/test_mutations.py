"""Damaged plotfiles: a clear error or a right reading, in bounded time and memory; nothing else."""

from __future__ import annotations

import os
import resource
import struct
import time
from pathlib import Path

import numpy as np
import pytest

from febkit import results
from febkit.model import InputError
from febkit.results.summary import summarize

COUNT = int(os.environ.get("FEBKIT_MUTATIONS", "150"))  # per kind of file
SEED = int(os.environ.get("FEBKIT_SEED", "2024"))
WORDS = (0, 1, 2, 7, 64, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0xFFFFFFF8, 0x01000000, 0x01040000, 0x02000000, 0x10000000)


def mutate(rng: np.random.Generator, raw: bytes) -> bytes:
    """One to three of: a byte, a word, a cut, a piece lost, doubled or moved."""
    data = bytearray(raw)
    for _ in range(int(rng.integers(1, 4))):
        at = int(rng.integers(0, max(len(data), 1)))
        kind = rng.integers(0, 6)
        if kind == 0 and data:
            data[at] ^= 1 << int(rng.integers(0, 8))
        elif kind == 1 and len(data) >= 8:
            at = at // 4 * 4 if rng.random() < 0.8 else at
            data[at : at + 4] = struct.pack("<I", int(rng.choice(WORDS)))
        elif kind == 2:
            del data[at:]
        elif kind == 3:
            del data[at : at + int(rng.integers(1, 64))]
        elif kind == 4:
            data[at:at] = data[at : at + int(rng.integers(1, 64))]
        else:
            data[at:at] = bytes(rng.integers(0, 256, int(rng.integers(1, 16)), dtype=np.uint8))
    return bytes(data)


def exercise(path: Path) -> str:
    """Read everything there is; "error" where it was refused."""
    try:
        for ds in results.open_all(path):
            ds.load()
            ds.close()
        summarize(path, every=True)
    except InputError as e:
        assert str(e)
        return "error"
    return "read"


@pytest.mark.filterwarnings("ignore:.*no complete state")
@pytest.mark.parametrize("kind", ["plain", "block", "body", "big-endian"])
def test_damaged_files(tmp_path: Path, make_modern, random_plot, kind: str) -> None:
    path = tmp_path / "a.xplt"
    options = {"block": {"packed": "block"}, "body": {"packed": "body"}, "big-endian": {"order": ">"}}
    sources = [make_modern(**options.get(kind, {}))]
    if kind in ("plain", "block"):
        random_plot(path, 1, 2, some=12, compress=kind == "block")
        sources.append(path.read_bytes())
    rng = np.random.default_rng(SEED)
    seen = {"error": 0, "read": 0}
    slowest = 0.0
    for _ in range(COUNT):
        path.write_bytes(mutate(rng, sources[int(rng.integers(len(sources)))]))
        start = time.process_time()
        seen[exercise(path)] += 1
        slowest = max(slowest, time.process_time() - start)
    assert slowest < 5.0
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < 2_000_000  # kB
    assert min(seen.values()) > COUNT // 20, seen


def test_a_bomb_is_bounded_by_its_size(tmp_path: Path, make_modern) -> None:
    """A compressed state that would inflate to 200 MB is counted piece by piece and refused."""
    import zlib

    plain = make_modern(states=0)
    bomb = struct.pack("<II", 0x02000000, 10) + bytes(200_000_000)
    (tmp_path / "a.xplt").write_bytes(plain + zlib.compress(bomb, 9))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    del bomb
    with pytest.raises(InputError, match="compressed data is no state"):
        results.open(tmp_path / "a.xplt")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000
