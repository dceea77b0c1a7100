"""Damaged inputs give a clear error or a model that can be checked and written; nothing else."""

import os
import random
import time
from pathlib import Path

import pytest

from febkit.feb import read_bytes, to_bytes
from febkit.feb.convert import VERSIONS
from febkit.feb.validation import check
from febkit.model import InputError
from helpers.mutate import mutate

DATA = sorted((Path(__file__).parent / "data").glob("*.feb"))
COUNT = int(os.environ.get("FEBKIT_FUZZ", "600"))
SLOWEST = 5.0  # s for one small input


def attempt(data: bytes, version: str) -> str:
    """Reads, checks and converts; returns how far it got."""
    try:
        model = read_bytes(data, "fuzz.feb")
    except InputError as e:
        assert e.message and len(e.message) < 2000
        return "refused"
    check(model)
    try:
        out, _ = to_bytes(model, version)
        read_bytes(out, "again.feb")
    except InputError:
        return "read"
    return "converted"


@pytest.mark.parametrize("path", DATA, ids=lambda p: p.stem)
def test_damaged_inputs(path):
    rng = random.Random(path.stem)
    original = path.read_bytes()
    seen = {"refused": 0, "read": 0, "converted": 0}
    for _ in range(COUNT // len(DATA)):
        data = mutate(original, rng)
        start = time.perf_counter()
        seen[attempt(data, rng.choice(VERSIONS))] += 1
        assert time.perf_counter() - start < SLOWEST
    assert seen["refused"] and seen["converted"]
