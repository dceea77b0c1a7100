"""What is left of the memory, by the machine's word and a control group's."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from febkit.solver.linear import memory


def test_something_is_left() -> None:
    assert memory.available() > 1e7


@pytest.mark.skipif(sys.platform == "win32", reason="control groups are Linux's")
def test_a_control_group_counts_with_its_cache_given_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "CGROUP", tmp_path)
    assert memory._container() == float("inf")
    (tmp_path / "memory.max").write_text("2000000\n")
    (tmp_path / "memory.current").write_text("1500000\n")
    (tmp_path / "memory.stat").write_text("anon 900000\ninactive_file 400000\n")
    assert memory._container() == 900000.0
    assert memory.available() == 900000.0
    (tmp_path / "memory.max").write_text("max\n")
    assert memory._container() == float("inf")
