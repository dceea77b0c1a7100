"""Published models (FEBio's TestSuite and the study's): read, checked, returned, carried down and up."""

import os
from pathlib import Path

import pytest

from febkit.feb import diff, read, read_bytes, to_bytes
from febkit.feb.validation import check

SHARED = Path(__file__).parents[2].parent / "shared" / "oracle"
MODELS = sorted(SHARED.glob("*/models/*.feb"))
EVERY = 1 if os.environ.get("FEBKIT_FULL") else 24
SOME = [p for p in MODELS[::EVERY] if EVERY == 1 or p.stat().st_size < 500_000]
pytestmark = pytest.mark.skipif(not MODELS, reason="the published models are not here")


def explained(difference, notes):
    """A difference that a note announces, or a set that spells out a reference."""
    said = " ".join(notes)
    what = difference.what
    if what.startswith(("node set", "element set")) and difference.a == "missing":
        return True
    if what == "units":
        return "units" in said
    for word in ("edge", "part list", "load controller", "nodal_load", "rigid_constraint", "BeamDomain"):
        if word in said and (word.split("_")[0] in what or (word == "part list" and "map" in what)):
            return True
    tag = what.rpartition("/")[2].partition("[")[0]
    return f"<{tag}>" in said or (what.startswith("domain") and "cannot ask for type" in said)


@pytest.mark.parametrize("path", SOME, ids=lambda p: f"{p.parts[-3]}-{p.stem}")
def test_published_model(path):
    model = read(path)
    assert to_bytes(model)[0] == path.read_bytes()
    assert [f for f in check(model) if f.severity == "error"] == []
    notes, carried = [], model
    for version in ("3.0", "2.5", "4.0"):
        data, more = to_bytes(carried, version)
        notes += more
        carried = read_bytes(data, str(path))
        assert carried.version == version
    assert [str(d) for d in diff(model, carried) if not explained(d, notes)] == []
