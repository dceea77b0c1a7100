"""The first run of a kind of model says that it compiles, and does not count that as solving; later ones do not."""

from __future__ import annotations

import os
import re
import sys
import time
from pathlib import Path
from typing import NamedTuple

import pytest

from helpers import damage
from helpers.command import FEBKIT, febkit
from helpers.files import load

MODEL = load(Path(__file__).parents[1] / "benchmarks" / "startup.py").MODEL
SAID = "one.feb: compiling the kernels that it needs, once on this machine"
CLOSING = re.compile(r"solved to t = 1 in (\S+) s.*compiling (\d+) kernels took (\S+) s more, once on this", re.S)


class Cold(NamedTuple):
    """A run with nothing on disk: where, what it said on stdout and stderr, its log, seconds."""

    folder: Path
    out: str
    err: str
    log: str
    seconds: float


def _run(folder: Path, *options: str) -> tuple[str, str]:
    (folder / "one.feb").write_text(MODEL)
    env = {"FEBKIT_CACHE": str(folder / "cache"), "FEBKIT_NATIVE": "0"}  # nothing that came with a wheel
    done = febkit("run", "one.feb", *options, folder=folder, env=env)
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr


def _kept(folder: Path) -> list[Path]:
    return sorted((folder / "cache").rglob("*.o"))


def _harm(files: list[Path]) -> None:
    """Each in a way of its own."""
    ways = [*damage.WAYS.values()]
    for k, path in enumerate(files):
        path.write_bytes(ways[k % len(ways)](path.read_bytes()))


@pytest.fixture(scope="module")
def cold(tmp_path_factory: pytest.TempPathFactory) -> Cold:
    folder, start = tmp_path_factory.mktemp("cold"), time.monotonic()
    out, err = _run(folder)
    return Cold(folder, out, err, (folder / "one.log").read_text(), time.monotonic() - start)


def test_said_in_a_line_and_counted_apart(cold: Cold) -> None:
    assert cold.err.count(SAID) == 1
    found = CLOSING.search(cold.out)
    assert found, cold.out
    solving, kernels, compiling = float(found[1]), int(found[2]), float(found[3])
    assert kernels > 5 and solving < compiling and solving + compiling < cold.seconds
    assert len(re.findall(r"^compiling \w+\.\w+$", cold.log, re.M)) == kernels
    (logged,) = re.findall(r"^\tcompiling: (\S+) s", cold.log, re.M)
    assert float(logged) == pytest.approx(compiling, abs=0.006)


def test_the_next_run_finds_all(cold: Cold) -> None:
    assert all(p.stat().st_mode & 0o077 == 0 for p in _kept(cold.folder)) or sys.platform == "win32"
    out, err = _run(cold.folder)
    assert "compiling" not in out + err + (cold.folder / "one.log").read_text()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudoterminals")
def test_damaged_files_are_made_again_and_a_terminal_sees_which(cold: Cold) -> None:
    import pty

    result = (cold.folder / "one.xplt").read_bytes()
    quick = sorted(_kept(cold.folder), key=lambda p: p.stat().st_size)[:7]
    _harm(quick)
    ours = {"FEBKIT_CACHE": str(cold.folder / "cache"), "FEBKIT_NATIVE": "0", "TERM": "xterm", "COLUMNS": "200"}
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(cold.folder)
        os.execve(FEBKIT, [str(FEBKIT), "run", "one.feb"], {**os.environ, **ours})
    said = b""
    try:
        while block := os.read(terminal, 4096):
            said += block
    except OSError:  # Linux's way of saying that the other side has gone
        pass
    os.close(terminal)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
    numbers = re.findall(r"compiling kernel (\d+) \(", said.decode(errors="replace"))
    assert {int(n) for n in numbers} <= set(range(1, 8)) and len(set(numbers)) > 2
    assert (cold.folder / "one.xplt").read_bytes() == result
    assert "compiling" not in "".join(_run(cold.folder))


def test_no_writable_folder_is_said_once(tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file, where a folder should be")
    out, err = _run(tmp_path)
    assert err.count("cannot be kept") == 1 and "FEBKIT_CACHE" in err
    assert "compiling the kernels" in err and "took" in out and "once on this" not in out + err
    assert (tmp_path / "one.log").read_text().count("cannot be kept") == 1
