"""Solves of a study that go on where a sitting ended."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import febkit
from febkit import materials as mt
from febkit import study
from febkit.model import InputError
from febkit.solver.run import Listener
from febkit.solving import solve
from febkit.study import work
from febkit.study.store import Store
from helpers import memory


def pressed(folder: Path, by: float) -> Path:
    m = febkit.Model("solid", units="mm-N-s")
    m.add_block("b", (1.0, 1.0, 1.0), (1, 1, 1))
    m.materials["s"] = mt.NeoHookean(E=1.0, v=0.3)
    m.fix(m.nodes(z=0), "x", "y", "z")
    m.prescribe(m.nodes(z="max"), z=-by, curve=[(0, 0), (1, 1)])
    m.step(time=1, dt=0.1)
    folder.mkdir()
    m.write(folder / work.MODEL)
    return folder


@pytest.fixture
def model(tmp_path: Path) -> Path:
    return pressed(tmp_path / "model", 0.3)


def sitting(store: Store, model: Path, key: str, every: str = "1steps") -> dict[str, Any]:
    with store.making(key, {}) as (folder, record):
        work.solve(work.Job(folder, {}, {"model": model}, record, {}, work.Try(every=every, begun=store.begun(key))))
    return store.record(key)


def interrupted_at(monkeypatch: pytest.MonkeyPatch, step: int) -> list[int]:
    """Ctrl-C within a step of the solves to come; the steps that are solved."""
    solved: list[int] = []

    class CtrlC(Listener):
        def iteration(self, run: Any, it: object) -> None:
            if run.totals.steps == step:
                raise KeyboardInterrupt

        def stepped(self, run: Any) -> None:
            solved.append(run.totals.steps)

    monkeypatch.setattr("febkit.solving.solve", lambda *a, **more: solve(*a, **more | {"listeners": [CtrlC()]}))
    return solved


def test_an_interrupted_solve_goes_on_in_the_next_sitting(tmp_path, model, monkeypatch):
    store = Store(tmp_path / "study")
    whole = sitting(store, model, "a" * 32)
    solved = interrupted_at(monkeypatch, 6)
    with pytest.raises(KeyboardInterrupt):
        sitting(store, model, "b" * 32)
    assert not store.has("b" * 32) and solved[-1] == 6
    (store.begun("b" * 32) / "since").write_text("1000.0 1e12")  # an earlier sitting of 1,000 s; none since
    solved = interrupted_at(monkeypatch, 99)
    record = sitting(store, model, "b" * 32)
    assert solved == [7, 8, 9, 10] and record["steps"] == 10 and record["iterations"] == whole["iterations"]
    assert 1000.0 < record["seconds"] < 1100.0 and not store.begun("b" * 32).exists()
    one, other = (store.path(k * 32) / work.RESULTS for k in "ab")
    assert one.read_bytes() == other.read_bytes()
    assert (store.path("b" * 32) / "run.log").is_file()


@pytest.mark.skipif(sys.platform != "linux", reason="the system does not let a process forget its peak")
def test_each_solve_is_told_its_own_peak_of_memory(tmp_path, model):
    """Not that of a larger one that the process did before."""
    store = Store(tmp_path / "study")
    large = np.ones(100_000_000)  # 800 MB
    before = memory.peak()
    del large
    assert sitting(store, model, "a" * 32)["peak_memory_mb"] < 1e-3 * before - 600.0


def test_what_another_febkit_began_is_begun_anew(tmp_path, model, monkeypatch):
    store = Store(tmp_path / "study")
    interrupted_at(monkeypatch, 6)
    with pytest.raises(KeyboardInterrupt):
        sitting(store, model, "b" * 32)
    saved = store.begun("b" * 32) / "run.checkpoint"
    saved.write_bytes(saved.read_bytes()[:-1])
    solved = interrupted_at(monkeypatch, 99)
    record = sitting(store, model, "b" * 32)
    assert solved == list(range(1, 11)) and "damaged" in record["warnings"][0]


def test_a_solve_that_fails_leaves_nothing_to_go_on_from(tmp_path):
    store = Store(tmp_path / "study")
    with pytest.raises(work.SolveFailed):
        sitting(store, pressed(tmp_path / "flat", 1.5), "c" * 32)
    assert not store.begun("c" * 32).exists()


def test_how_often_is_a_time_or_a_number_of_steps(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text('cases = ["A"]\nmethods = ["1"]\n\n[run]\ncheckpoint = "soon"\n')
    with pytest.raises(InputError, match=r"study.toml:5: checkpoint of \[run\] must be a time or a number of steps"):
        study.read(file)
    file.write_text('cases = ["A"]\nmethods = ["1"]\n\n[run]\ncheckpoint = "10min"\n')
    assert study.read(file).resources.checkpoint == "10min"
