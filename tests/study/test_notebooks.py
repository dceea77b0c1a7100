"""The notebooks of examples/ run from top to bottom at reduced size."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
NOTEBOOKS = sorted((EXAMPLES / "notebooks").glob("*.ipynb"))


def cells(path: Path) -> list[str]:
    found = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(c["source"]) for c in found if c["cell_type"] == "code"]


def test_there_are_four():
    assert [p.name[0] for p in NOTEBOOKS] == list("abcd")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebook(path, tmp_path, monkeypatch):
    source = cells(path)  # what they import is in the extra "test": none of them is skipped
    (tmp_path / "notebooks").mkdir()
    shutil.copy(EXAMPLES / "study_reduced.toml", tmp_path)
    monkeypatch.chdir(tmp_path / "notebooks")
    monkeypatch.setenv("FEBKIT_EXAMPLES", "small")
    names: dict[str, object] = {"__name__": "__main__"}
    for k, text in enumerate(source):
        exec(compile(text, f"{path.name}[{k}]", "exec"), names)
    if path.name.startswith("c"):
        assert names["summary"].complete  # type: ignore[attr-defined]
        written = {p.name for p in names["written"]}  # type: ignore[attr-defined]
        assert written >= {"histories_A.png", "exchange_A.png", "outside_limits.png", "section_A.png", "report.md"}
