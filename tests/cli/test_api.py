"""What is given to febkit.solve, read, write and open_results by mistake is answered in words, nothing being solved."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import febkit
from febkit.model import InputError


@pytest.fixture
def model(tmp_path: Path, plug: str) -> Path:
    path = tmp_path / "plug.feb"
    path.write_text(plug)
    return path


def test_solve_takes_a_path(model: Path) -> None:
    by_path, by_text = febkit.solve(model), febkit.solve(str(model))
    assert by_path.converged and by_text.converged
    assert (by_path.state.u == febkit.solve(febkit.read(model)).state.u).all()
    with pytest.raises(InputError, match="No such file"):
        febkit.solve(model.with_name("none.feb"))


@pytest.mark.parametrize(("option", "words"), [
    ({"linear": "mumps"}, "linear = 'mumps' is none of auto, pardiso, superlu, dense, iterative"),
    ({"factor": "sometimes"}, "factor = 'sometimes' is none of auto, fresh, reuse"),
    ({"threads": -3}, "threads = -3: give a whole number"), ({"threads": 1.5}, "threads = 1.5"),
    ({"accuracy": 2}, "accuracy = 2: give a number of 0 to 0.1"),
    ({"tolerance": 1}, "tolerance = 1: give a number"), ({"accuracy": float("nan")}, "accuracy = nan"),
    ({"memory": -1.0}, "memory = -1.0"), ({"stabilise": float("inf")}, "stabilise = inf"),
    ({"plotfile": ""}, "needs a name"),
])  # fmt: skip
def test_options_that_mean_nothing(model: Path, option: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        febkit.solve(model, **{"plotfile": model.with_suffix(".xplt"), **option})
    assert not model.with_suffix(".xplt").exists()


@pytest.mark.parametrize(("call", "words"), [
    (lambda m: febkit.solve(3), "a model or the path"),  # type: ignore[arg-type]
    (lambda m: febkit.solve(m, plotfile=3), "PathLike"),  # type: ignore[arg-type]
    (lambda m: febkit.write("a.feb", m), "write\\(model, path\\)"),
    (lambda m: febkit.read(None), "PathLike"), (lambda m: febkit.open_results(3), "PathLike"),
])  # fmt: skip
def test_things_of_another_type(model: Path, call: Any, words: str) -> None:
    with pytest.raises(TypeError, match=words):
        call(febkit.read(model))


def test_a_solver_that_is_not_installed_is_no_failure_to_converge(model: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from febkit.solver.linear import pardiso

    monkeypatch.setattr(pardiso, "library", lambda: None)
    with pytest.raises(InputError, match="needs MKL: pip install mkl"):
        febkit.solve(model, linear="pardiso")
    assert febkit.solve(model).converged, "auto does without"


@pytest.mark.parametrize(("name", "words"), [
    ("none.xplt", "No such file"), ("empty.xplt", "fewer than four bytes"), ("plug.feb", "not an FEBio plotfile"),
    ("text.nc", "not a NetCDF file"), ("folder.xplt", "no regular file"),
])  # fmt: skip
def test_what_is_no_result(model: Path, name: str, words: str) -> None:
    (model.parent / "empty.xplt").touch()
    (model.parent / "text.nc").write_text("hello")
    (model.parent / "folder.xplt").mkdir()
    with pytest.raises((InputError, OSError), match=words) as caught:
        febkit.open_results(model.with_name(name))
    assert name in str(caught.value)


def test_versions_may_be_numbers(model: Path) -> None:
    febkit.write(febkit.read(model), model.with_name("old.feb"), version=2.5)  # type: ignore[arg-type]
    assert febkit.read(model.with_name("old.feb")).version == "2.5"


def test_completion_finds_what_is_loaded_late() -> None:
    code = ("import febkit, febkit.feb, febkit.metrics, febkit.plots, febkit.coupling, febkit.study as s\n"
            "for m, n in ((febkit, 'solve open_results read write'), (febkit.feb, 'read validate diff'),\n"
            "             (febkit.metrics, 'cell_metrics'), (febkit.plots, 'histories'), (febkit.coupling, 'series'),\n"
            "             (s, 'carry_out')):\n"
            "    assert set(n.split()) <= set(dir(m)), (m, dir(m))\n"
            "try: febkit.metrics.nosuch\n"
            "except AttributeError as e: assert str(e) == \"module 'febkit.metrics' has no attribute 'nosuch'\", e")
    subprocess.run([sys.executable, "-c", code], check=True)
