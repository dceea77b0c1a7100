"""The table of docs/beside.md: its lines of code are those of the scripts, which run where their packages are."""

from __future__ import annotations

import os
import re
import runpy
import shutil
from importlib.util import find_spec
from pathlib import Path

import pytest

from helpers.files import load
from helpers.pages import furnish

ROOT = Path(__file__).parents[2]
OTHERS = ROOT / "tests" / "benchmarks" / "side_by_side"
TASKS = ("plug", "sweep", "reaction", "strain", "paraview", "edit")
PACKAGES = ("febkit", "pyfebio", "felupe", "skfem")
lines_of_code = load(Path(__file__).with_name("test_newcomer.py")).lines_of_code


def script(task: str, package: str) -> Path:
    return ROOT / "examples" / "newcomer" / f"{task}.py" if package == "febkit" else OTHERS / f"{task}_{package}.py"


def test_the_table_says_what_the_scripts_are() -> None:
    rows = re.findall(r"^\| (?!\||-)(.*) \|$", (ROOT / "docs" / "beside.md").read_text(), re.M)[-len(TASKS) :]
    for task, row in zip(TASKS, rows, strict=True):
        for package, cell in zip(PACKAGES, row.split(" | ")[1:], strict=True):
            path, said = script(task, package), re.match(r"(\d+)", cell)
            assert (said is not None) == path.is_file(), f"{task}, {package}: {cell}"
            if said is not None:
                assert int(said[1]) == lines_of_code(path), f"{task}, {package}: {cell}, not {lines_of_code(path)}"
                assert max(map(len, path.read_text().splitlines())) <= 110


@pytest.mark.parametrize("name", ["plug_felupe", "plug_skfem"])
def test_other_packages_give_the_force_at_rest(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """felupe's solid is that of febkit; scikit-fem's strains are small."""
    if find_spec(name.partition("_")[2]) is None:
        pytest.skip("the package is not installed")
    furnish(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(os.environ, "MPLBACKEND", "agg")
    shutil.copy(OTHERS / f"{name}.py", tmp_path)
    force = runpy.run_path(f"{name}.py")["force"]
    assert abs(force[-1]) == pytest.approx(0.0240224, rel=1e-4 if "felupe" in name else 0.04)
