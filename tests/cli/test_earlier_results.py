"""Results of an earlier run are never lost before there are new ones, and never mixed with them."""

from __future__ import annotations

import os
import re
import signal
import time

import pytest

import febkit as package
from febkit.results.xplt.reader import PlotFile
from helpers import descriptors
from helpers.killed import kill_at_random, states

LIMITED = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, ({0}, {0}))"  # bytes of a file
HIDDEN = ".febkit.m.xplt"
pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals and limits differ on Windows")


def wait(true, seconds: float = 60.0) -> None:
    until = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < until
        time.sleep(0.005)


def test_a_run_that_fails_at_its_first_step_leaves_the_earlier_plotfile(tmp_path, febkit, model) -> None:
    (tmp_path / "m.feb").write_text(model(steps=20))
    done = febkit("run", "m.feb")
    assert done.returncode == 0 and "earlier" not in done.stdout
    before = (tmp_path / "m.xplt").read_bytes()
    (tmp_path / "m.feb").write_text(model(steps=1, to=-1.5))
    done = febkit("run", "m.feb")
    assert done.returncode == 1
    assert "m.xplt is still that of an earlier run" in done.stdout
    assert (tmp_path / "m.xplt").read_bytes() == before
    assert "E R R O R   T E R M I N A T I O N" in (tmp_path / "m.log").read_text(), "the log is that of the last run"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["m.feb", "m.log", "m.xplt"]


def test_without_an_earlier_one_the_initial_state_stays(tmp_path, febkit, model) -> None:
    (tmp_path / "m.feb").write_text(model(steps=1, to=-1.5))
    assert febkit("run", "m.feb").returncode == 1
    assert states(tmp_path / "m.xplt") == 1


def test_a_second_run_replaces_the_first_and_says_so(tmp_path, febkit, model) -> None:
    (tmp_path / "m.feb").write_text(model(steps=20))
    febkit("run", "m.feb")
    (tmp_path / "m.feb").write_text(model(steps=3))
    done = febkit("run", "m.feb")
    assert done.returncode == 0 and "over an earlier one" in done.stdout
    assert states(tmp_path / "m.xplt") == 4


def test_bad_input_leaves_plotfile_and_log(tmp_path, febkit, model) -> None:
    (tmp_path / "m.feb").write_text(model())
    febkit("run", "m.feb")
    before = {n: (tmp_path / n).read_bytes() for n in ("m.xplt", "m.log")}
    (tmp_path / "m.feb").write_text(model(e="soft"))
    assert febkit("run", "m.feb").returncode == 2
    assert before == {n: (tmp_path / n).read_bytes() for n in before}


def test_two_runs_into_one_plotfile(tmp_path, febkit, start, model) -> None:
    (tmp_path / "m.feb").write_text(model(steps=100000))
    first = start("run", "m.feb", "-silent")
    wait(lambda: (tmp_path / "m.xplt").exists())
    for args in (("-o", "other.log"), ("-p", "other.xplt")):  # one shared file is enough
        done = febkit("run", "m.feb", *args)
        assert done.returncode == 2
        assert re.search(rf"m\.(xplt|log): process {first.pid} is writing to this file", done.stderr), done.stderr
    assert first.poll() is None
    first.send_signal(signal.SIGINT)
    first.communicate(timeout=60)
    assert first.returncode == 130
    assert states(tmp_path / "m.xplt") >= 1
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]


def test_a_dead_run_blocks_nothing(tmp_path, febkit, start, model) -> None:
    (tmp_path / "m.feb").write_text(model(steps=3))
    febkit("run", "m.feb")
    (tmp_path / "long.feb").write_text(model(steps=100000))
    job = start("run", "long.feb", "-p", "m.xplt", "-o", "m.log", "-silent")
    wait(lambda: (tmp_path / HIDDEN).exists() or states(tmp_path / "m.xplt") > 4)
    job.kill()
    job.communicate()
    done = febkit("run", "m.feb")
    assert done.returncode == 0, done.stderr
    assert states(tmp_path / "m.xplt") == 4
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]


def test_killed_at_random_moments(tmp_path, model) -> None:
    """The plotfile opens with every state that the log announced; the earlier one stays until there is a new one.

    tests/benchmarks/killed.py does it 50 times.
    """
    found = kill_at_random(tmp_path, model(steps=7), model(steps=1000), kills=10, seed=1)
    assert found.within + found.whole, "killed too early each time to show anything"


def test_a_full_disk(tmp_path, febkit, model) -> None:
    """The message names the file, complete states stay, an earlier result stays where there is no new one."""

    (tmp_path / "m.feb").write_text(model(steps=200))
    assert febkit("run", "m.feb", "-silent").returncode == 0  # compiles what there is to compile
    size = (tmp_path / "m.xplt").stat().st_size
    before = (tmp_path / "m.xplt").read_bytes()
    done = febkit("run", "m.feb", "-o", os.devnull, before=LIMITED.format(1000))
    assert done.returncode not in (0, 1) and "m.xplt" in done.stderr and "too large" in done.stderr
    assert (tmp_path / "m.xplt").read_bytes() == before
    assert sorted(p.name for p in tmp_path.iterdir()) == ["m.feb", "m.log", "m.xplt"]
    done = febkit("run", "m.feb", "-o", os.devnull, before=LIMITED.format(size // 2))
    assert done.returncode not in (0, 1) and "m.xplt" in done.stderr
    with PlotFile(tmp_path / "m.xplt") as f:
        assert f.container.leftover == 0, "no partial state"
    assert 90 < states(tmp_path / "m.xplt") < 110


def test_a_full_disk_for_the_log(tmp_path, febkit, model) -> None:
    (tmp_path / "m.feb").write_text(model(steps=200))
    assert febkit("run", "m.feb", "-silent").returncode == 0
    done = febkit("run", "m.feb", "-p", os.devnull, before=LIMITED.format(20000))
    assert done.returncode not in (0, 1) and "m.log" in done.stderr


def test_a_solve_that_raises_leaves_nothing_open(tmp_path, model) -> None:
    from febkit.solver.run import Listener

    class Broken(Listener):
        def converged(self, run, counts) -> None:
            if run.totals.steps == 3:
                raise RuntimeError("broken listener")

    (tmp_path / "m.feb").write_text(model(log='<node_data data="x" file="x.txt"/>'))
    with pytest.raises(RuntimeError, match="broken listener"):
        package.solve(package.read(tmp_path / "m.feb"), tmp_path / "m.xplt", tmp_path / "m.log", listeners=[Broken()])
    if descriptors.PROC.is_dir():
        assert descriptors.held(tmp_path) == []
    assert states(tmp_path / "m.xplt") == 3, "states that were saved stay"
    log = (tmp_path / "m.log").read_text()
    assert "broken listener" in log and "E R R O R   T E R M I N A T I O N" in log
    package.solve(package.read(tmp_path / "m.feb"), tmp_path / "m.xplt", tmp_path / "m.log")
