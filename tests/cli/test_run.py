"""``febkit run`` from the command line: exit codes, what is written, and what is said."""

from __future__ import annotations

import importlib.util
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from helpers import forked

EXAMPLES = Path(__file__).parents[2] / "examples"


def _text(end: float = 20.0, n: int = 2, layers: int = 2) -> str:
    spec = importlib.util.spec_from_file_location("plug", EXAMPLES / "unconfined_compression.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return str(module.text(n, layers, max(end, 150.0)))


def run(*args: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return forked.febkit("run", *args, folder=folder)


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "plug.feb"
    path.write_text(_text())
    return path


def edit(path: Path, old: str, new: str) -> int:
    """Replace text once; the line it stood in."""
    text = path.read_text()
    assert text.count(old) == 1, old
    path.write_text(text.replace(old, new))
    return text[: text.index(old)].count("\n") + 1


def test_solves_writes_and_says_what(model: Path) -> None:
    done = run(model.name, folder=model.parent)
    assert done.returncode == 0, done.stderr
    for word in ("solved to t = 150", "largest displacement 0.", "fluid pressure", "plug.xplt", "plug.log"):
        assert word in done.stdout
    ds = febkit.open_results(model.with_suffix(".xplt"))
    assert float(ds.time[-1]) == 150.0
    log = model.with_suffix(".log").read_text()
    assert "N O R M A L   T E R M I N A T I O N" in log and "converged at time : 150" in log


def test_febios_spelling_and_silence(model: Path) -> None:
    done = run("-i", "plug.feb", "-o", "o.log", "-p", "p.xplt", "-silent", folder=model.parent)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "" and done.stderr == ""
    assert (model.parent / "o.log").is_file() and (model.parent / "p.xplt").is_file()


def test_the_plotfile_holds_the_solvers_state(model: Path) -> None:
    plot = model.with_suffix(".xplt")
    result = febkit.solve(febkit.read(model), plotfile=plot)
    ds = febkit.open_results(plot)
    np.testing.assert_allclose(ds["displacement"][-1], result.state.u, atol=1e-7)
    np.testing.assert_allclose(ds["effective_fluid_pressure"][-1], result.state.p, atol=1e-7)


@pytest.mark.parametrize(("old", "new"), [
    ('type="neo-Hookean"', 'type="no such solid"'),
    ('type="perm-const-iso"', 'type="perm-of-another-kind"'),
    ('type="zero fluid pressure" node_set="side"', 'type="normal fluid velocity" node_set="side"'),
], ids=["material", "permeability", "condition"])  # fmt: skip
def test_what_is_not_solved_is_refused_by_name_and_line(model: Path, old: str, new: str) -> None:
    line = edit(model, old, new)
    done = run(model.name, folder=model.parent)
    assert done.returncode == 2
    assert f"plug.feb:{line}" in done.stderr
    assert new.split('"')[1] in done.stderr
    assert "Traceback" not in done.stderr
    assert not model.with_suffix(".xplt").exists(), "nothing is solved"


@pytest.mark.parametrize(("old", "new", "word"), [
    ('mat="cartilage"', 'mat="bone"', "bone"),
    ('node_set="x0"', 'node_set="nowhere"', "nowhere"),
    ("<E>0.6</E>", "<E>six</E>", "six"),
    ('<value lc="1">', '<value lc="9">', "9"),
])  # fmt: skip
def test_bad_input_is_a_message_with_a_line(model: Path, old: str, new: str, word: str) -> None:
    line = edit(model, old, new)
    done = run(model.name, folder=model.parent)
    assert done.returncode == 2
    assert f"plug.feb:{line}" in done.stderr and word in done.stderr
    assert "Traceback" not in done.stderr


def test_broken_xml_and_missing_files(model: Path) -> None:
    model.write_text(model.read_text()[:3000])
    done = run(model.name, folder=model.parent)
    assert done.returncode == 2 and "plug.feb" in done.stderr and "Traceback" not in done.stderr
    done = run("none.feb", folder=model.parent)
    assert done.returncode == 2 and "none.feb" in done.stderr


def _turned_over(model: Path) -> None:
    """The plug pressed through its own bottom in fixed steps: elements must turn over before the end."""
    edit(model, ">-0.05<", ">-1.5<")
    text = model.read_text()
    start, end = text.index("<time_stepper"), text.index("</time_stepper>")
    model.write_text(text[:start] + text[end + len("</time_stepper>") :])


def test_elements_turned_over_end_cleanly(model: Path) -> None:
    _turned_over(model)
    done = run(model.name, folder=model.parent)
    assert done.returncode == 1, done.stdout
    assert "at time" in done.stderr and "Traceback" not in done.stderr
    assert "element" in done.stderr and "plug" in done.stderr
    ds = febkit.open_results(model.with_suffix(".xplt"))
    assert ds.sizes["time"] > 2, "states written so far stay readable"
    assert np.isfinite(np.asarray(ds["displacement"])).all()
    assert "E R R O R   T E R M I N A T I O N" in model.with_suffix(".log").read_text()


@pytest.mark.skipif(os.name == "nt", reason="signals differ on Windows")
def test_ctrl_c_leaves_a_readable_plotfile(tmp_path: Path) -> None:
    model = tmp_path / "long.feb"
    model.write_text(_text(end=1e5, n=3, layers=4))
    edit(model, "<pt>10,1</pt><pt>20,5</pt>", "<pt>10,0.02</pt><pt>20,0.02</pt>")
    program: Any = [sys.executable, "-m", "febkit.cli.main", "run", "long.feb", "-t", "1"]
    job = subprocess.Popen(program, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    plot, log = tmp_path / "long.xplt", tmp_path / "long.log"
    until = time.monotonic() + 120
    while time.monotonic() < until and not (log.exists() and log.read_text().count("converged at time") >= 3):
        assert job.poll() is None, job.communicate()
        time.sleep(0.1)
    job.send_signal(signal.SIGINT)
    _, said = job.communicate(timeout=60)
    assert job.returncode == 130
    assert "interrupted" in said and "Traceback" not in said
    ds = febkit.open_results(plot)
    assert ds.sizes["time"] >= 3
    assert np.isfinite(np.asarray(ds["displacement"][-1])).all()


@pytest.mark.parametrize(("E", "said"), [
    ('<E type="math">sqrt(-1-X)</E>', "its parameter E is nan"),  # not finite
    ("<E>1e120</E>", 'the plot variable "stress" is'),  # more than the 4 bytes of a plotfile hold
    ("<E>1e200</E>", "overflows"),  # its square is more than a double holds
])  # fmt: skip
def test_states_that_are_not_finite_are_not_written(model: Path, E: str, said: str) -> None:
    edit(model, "<E>0.6</E>", E)
    done = run(model.name, folder=model.parent)
    assert done.returncode == 1 and said in done.stderr.replace("\n", " ") and "Traceback" not in done.stderr
    if model.with_suffix(".xplt").exists():
        ds = febkit.open_results(model.with_suffix(".xplt"))
        assert all(np.isfinite(ds[name].values).all() for name in ("displacement", "stress"))
