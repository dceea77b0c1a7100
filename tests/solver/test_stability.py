"""The matrix of hard scenes (tests/benchmarks/stability.py): each is solved and keeps its bound."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "benchmarks"))
import stability


@pytest.mark.parametrize("name", stability.SCENES)
def test_scene(name: str) -> None:
    outcome = stability.SCENES[name]()
    assert outcome.result.converged, outcome.result.reason
    assert outcome.value <= outcome.bound
