""".ci/run reads a checkout and changes nothing in it; it is run here with tools that only pretend."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.skipif(
    not all(map(shutil.which, ("bash", "git", "tar"))), reason="needs bash, git and tar, as .ci/run does"
)

# python, pip, ruff, mypy and febkit: a venv gets copies of it, a build a wheel, a run its results; all calls are noted
TOOL = """#!/usr/bin/env bash
echo "$(basename "$0") $*" >> "$NOTED"
case "$(basename "$0") $*" in
  *"-m venv"*) mkdir -p "$3/bin"; for t in python python3 pip ruff mypy febkit; do cp "$TOOL" "$3/bin/$t"; done ;;
  *"-m build"*) mkdir -p "$6"; touch "$6/febkit-0-py3-none-any.whl" ;;
  "febkit run"*) echo x > unconfined_compression.xplt ;;
  "febkit new"*) echo x > tissue.feb ;;
  *"-m pytest"*) ls -A >> "$NOTED"; rm -rf README.md examples ;;
esac
"""


def _content(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_the_checkout_is_left_as_it_is(tmp_path: Path) -> None:
    checkout, tool, noted = tmp_path / "checkout", tmp_path / "tool", tmp_path / "noted"
    for name in (".ci/run", ".gitignore", "README.md", "examples/unconfined_compression.feb"):
        (checkout / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, checkout / name)
    (checkout / "venv").mkdir()
    (checkout / "venv" / "months of work").write_text("kept")
    subprocess.run(["git", "init", "-q", str(checkout)], check=True)
    (checkout / "gone").touch()
    subprocess.run(["git", "-C", str(checkout), "add", "-A"], check=True)
    (checkout / "gone").unlink()
    (checkout / "a new file").write_text("not yet added")
    tool.write_text(TOOL)
    tool.chmod(0o755)
    before = _content(checkout)
    env = {**os.environ, "PYTHON": str(tool), "TOOL": str(tool), "NOTED": str(noted), "TMPDIR": str(tmp_path)}
    done = subprocess.run([str(checkout / ".ci" / "run")], env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert _content(checkout) == before
    calls = noted.read_text()
    for expected in ("ruff check .", "mypy", "-m build", "febkit run", "febkit new", "-m pytest"):
        assert expected in calls
    assert "a new file" in calls.rpartition("-m pytest")[2] and "months" not in calls  # the tests ran in the copy
    assert [p for p in tmp_path.iterdir() if p.name.startswith("tmp.")] == []
