"""FEBio's options, signals, pipes, strange names, and what nobody foresaw: the installed command as a process."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import febkit
from febkit.cli import febio_options, printing
from febkit.metrics.tables import Table
from helpers import command, forked
from helpers.command import FEBKIT

from .conftest import pulled

ROOT = Path(__file__).parents[2]
posix = pytest.mark.skipif(os.name == "nt", reason="signals, pipes and names differ on Windows")
EXAMPLE = ROOT / "examples" / "unconfined_compression.feb"


@pytest.fixture
def model(tmp_path: Path, plug: str) -> Path:
    path = tmp_path / "plug.feb"
    path.write_text(plug)
    return path


# ---- FEBio's command line ---------------------------------------------------------------------------
@pytest.mark.parametrize("args", [
    ["plug.feb"], ["plug"], ["run", "plug"], ["-i", "plug.feb"], ["-i", "plug", "-nosplash", "-noconfig"],
    ["plug.feb", "-task=solve"], ["-nosplash", "-i", "plug.feb", "-noappend"],
])  # fmt: skip
def test_febios_ways_to_solve_a_model(model: Path, args: list[str]) -> None:
    done = forked.febkit(*args, folder=model.parent)
    assert done.returncode == 0 and "solved to t = " in done.stdout, done.stderr
    assert "warning" not in done.stderr and model.with_suffix(".xplt").is_file()


def test_options_that_change_nothing_are_said(model: Path) -> None:
    extra = ["-config", "febio.xml", "-g2", "-dump=2", "m.dmp", "-break", "0.5", "-import", "lib.so", "-cnf", "c.xml"]
    extra += ["-dump", "plug.dmp", "-o", "o.log", "-p", "-g.xplt"]
    done = forked.febkit("-i", "plug.feb", *extra, folder=model.parent)
    assert done.returncode == 0, done.stderr
    said = re.findall(r"^warning: (-\w+) is ignored: \w", done.stderr, re.M)
    assert said == ["-config", "-g2", "-dump", "-break", "-import", "-cnf", "-dump"]
    assert (model.parent / "-g.xplt").is_file() and (model.parent / "o.log").is_file()
    quiet = forked.febkit("plug.feb", "-g", "-silent", folder=model.parent)
    assert (quiet.returncode, quiet.stdout, quiet.stderr) == (0, "", "")


@pytest.mark.parametrize("args", [["-r", "m.dmp"], ["-d", "t.feb"], ["-norun"], ["-info"],
                                  ["-task=optimize", "c.xml"], ["-task"]])  # fmt: skip
def test_other_tasks_are_refused_in_a_line(model: Path, args: list[str]) -> None:
    done = forked.febkit("-i", "plug.feb", *args, folder=model.parent)
    assert done.returncode == 2 and done.stdout == ""
    assert len(done.stderr.splitlines()) == 1 and args[0] in done.stderr
    assert not model.with_suffix(".xplt").exists()


def test_the_docs_name_every_option_of_febios() -> None:
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    for name, option in febio_options.OPTIONS.items():
        what = "refused" if option.task else "ignored" if option.why else "accepted"
        row = next(line for line in text.splitlines() if line.startswith("|") and f"`{name}`" in line)
        assert row.split("|")[2].strip().startswith(what), row


def test_a_plotfile_for_paraview_is_one(model: Path) -> None:
    done = forked.febkit("plug.feb", "-p", "p.pvd", folder=model.parent)
    assert done.returncode == 0, done.stderr
    assert (model.parent / "p.pvd").read_text().startswith("<?xml")
    assert febkit.open_results(model.parent / "p.xplt").sizes["time"] == len(list(model.parent.glob("p_*.vtu")))
    for ending in ("vtk", "plt", "nc", "feb", "csv"):
        name = f"q.{ending}"
        done = forked.febkit("plug.feb", "-p", name, folder=model.parent)
        assert done.returncode == 2 and name in done.stderr and not (model.parent / name).exists()


# ---- run and validate ---------------------------------------------------------------------------------
def test_run_says_what_validate_says(model: Path) -> None:
    text = model.read_text().replace('mat="cartilage"', 'mat="bone"')
    model.write_text(text.replace("<phi0>", "<phi1>").replace("</phi0>", "</phi1>"))
    checked = forked.febkit("validate", "plug.feb", "-q", folder=model.parent)
    solved = forked.febkit("plug.feb", folder=model.parent)
    assert checked.returncode == solved.returncode == 2
    lines = checked.stdout.splitlines()
    assert lines and all(line.partition(": error: ")[2] in solved.stderr for line in lines), solved.stderr


# ---- signals --------------------------------------------------------------------------------------------
@posix
@pytest.mark.parametrize(("name", "code"), [("SIGTERM", 143), ("SIGHUP", 129), ("SIGINT", 130)])
def test_a_signal_ends_log_and_plotfile(tmp_path: Path, name: str, code: int) -> None:
    text = EXAMPLE.read_text()
    found = re.search(r"<time_steps>\d+</time_steps>", text)
    assert found is not None
    text = text.replace(found[0], "<time_steps>1000000</time_steps>")
    (tmp_path / "long.feb").write_text(re.sub(r"<time_stepper.*?</time_stepper>", "", text, flags=re.S))
    job = subprocess.Popen([str(FEBKIT), "long.feb", "-t", "1"], cwd=tmp_path, stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE, text=True)  # fmt: skip
    log, until = tmp_path / "long.log", time.monotonic() + 120
    while not (log.exists() and log.read_text().count("converged at time") >= 3):
        assert job.poll() is None and time.monotonic() < until, job.communicate()
        time.sleep(0.05)
    job.send_signal(getattr(signal, name))
    out, said = job.communicate(timeout=60)
    assert job.returncode == code
    assert "stopped at t = " in out and "interrupted" in said and "Traceback" not in said
    assert "E R R O R   T E R M I N A T I O N" in log.read_text()
    assert febkit.open_results(tmp_path / "long.xplt").sizes["time"] >= 3


@posix
def test_nohup_is_heeded() -> None:
    code = ("import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN); from febkit.cli import signals;"
            "signals.watch(); print(signal.getsignal(signal.SIGHUP) is signal.SIG_IGN)")  # fmt: skip
    assert subprocess.check_output([sys.executable, "-c", code], text=True).strip() == "True"


# ---- pipes and full disks -------------------------------------------------------------------------------
@posix
def test_a_reader_that_leaves_changes_no_exit_code(model: Path) -> None:
    d = model.parent
    (d / "other.feb").write_text(model.read_text().replace("<E>", "<E> 1"))
    for line, code in (("febkit plug.feb 2>&1", 0), ("febkit info plug.xplt", 0), ("febkit diff plug.feb other.feb", 1),
                       ("febkit validate plug.feb", 0), ("febkit --help", 0)):  # fmt: skip
        # the reader is gone before the first line is written
        r, w = os.pipe()
        os.close(r)
        both = "2>&1" in line
        done = subprocess.run([str(FEBKIT), *line.replace("2>&1", "").split()[1:]], cwd=d, stdout=w, check=False,
                              stderr=w if both else subprocess.PIPE, timeout=120)  # fmt: skip
        os.close(w)
        assert done.returncode == code, line
        assert both or done.stderr == b"", (line, done.stderr)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_output_on_a_full_disk_is_said(model: Path) -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([FEBKIT, "info", "plug.feb"], cwd=model.parent, stdout=full, stderr=subprocess.PIPE,
                              text=True, check=False)  # fmt: skip
    assert done.returncode == 2 and done.stderr.splitlines() == ["febkit: standard output: No space left on device"]


@posix
def test_closed_streams(model: Path) -> None:
    for redirect, code in ((">&-", 0), ("2>&-", 0), (">&- 2>&-", 0)):
        done = subprocess.run(["sh", "-c", f'"{FEBKIT}" info plug.feb {redirect}'], cwd=model.parent, check=False)
        assert done.returncode == code


# ---- names and places -----------------------------------------------------------------------------------
NAMES = [b"[/m].feb", b"[red]m.feb", b"b\xff.feb", "µm und Größe.feb".encode(), b"a\nb.feb", b"\x1b[31mred.feb",
         b"-g.feb"]  # fmt: skip
PLAIN = {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}


def named(folder: Path, name: bytes) -> Path:
    path = folder / os.fsdecode(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        path.write_text(pulled(steps=1))
    except OSError:
        pytest.skip("the file system takes no such name")
    return path


@posix
@pytest.mark.parametrize("name", NAMES)
def test_names_that_are_markup_or_no_text(tmp_path: Path, name: bytes) -> None:
    named(tmp_path, name)
    for start, env in ((forked.febkit, {}), (command.febkit, PLAIN)):
        done = start("run", "-i", os.fsdecode(name), folder=tmp_path, env=env)
        assert done.returncode == 0, done.stderr
        assert "wrote " in done.stdout and "\x1b" not in done.stdout + done.stderr
    shown = os.fsdecode(name).encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
    if "\n" not in shown and "\x1b" not in shown and shown.isascii():
        assert shown.removesuffix(".feb") + ".xplt" in done.stdout, "names are not cut and not eaten"


@posix
@pytest.mark.parametrize("env", [{}, PLAIN], ids=["UTF-8", "C"])
def test_such_names_are_validated(tmp_path: Path, env: dict[str, str]) -> None:
    names = [str(named(tmp_path, n).relative_to(tmp_path)) for n in NAMES]
    done = command.febkit("validate", "--", *names, folder=tmp_path, env=env)
    assert done.returncode == 0 and done.stdout.count("febkit can solve it") == len(names)
    assert "\x1b" not in done.stdout


@posix
def test_without_a_home(model: Path) -> None:
    env = {k: v for k, v in os.environ.items() if k not in ("HOME", "USER", "LOGNAME")}
    done = subprocess.run([FEBKIT, "plug.feb"], cwd=model.parent, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "solved" in done.stdout, done.stderr


# ---- what nobody foresaw --------------------------------------------------------------------------------
def _failing(folder: Path, raises: str, **env: str) -> subprocess.CompletedProcess[str]:
    code = (f"import sys, febkit.feb.read as r\ndef broken(*a, **k): raise {raises}\n"
            "r.read = broken\nimport febkit.feb; febkit.feb.read = broken\n"
            "sys.argv = ['febkit', 'info', 'plug.feb']\nfrom febkit.cli.main import main; main()")  # fmt: skip
    return subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False,
                          env={**os.environ, "TMPDIR": str(folder), **env})  # fmt: skip


def test_a_fault_is_one_sentence_and_a_log_of_it(model: Path) -> None:
    done = _failing(model.parent, "LookupError('no such\\nthing ' + 'x' * 1000)")
    assert done.returncode == 70 and done.stdout == ""
    assert len(done.stderr.splitlines()) == 1 and "Traceback" not in done.stderr and len(done.stderr) < 500
    (log,) = model.parent.glob("febkit-crash-*.log")
    assert str(log) in done.stderr
    text = log.read_text()
    assert "Traceback" in text and "no such\nthing" in text and f"febkit {febkit.__version__}" in text
    assert "['info', 'plug.feb']" in text


def test_no_memory_is_no_fault(model: Path) -> None:
    done = _failing(model.parent, "MemoryError('Unable to allocate 3 TiB')")
    assert done.returncode == 2 and done.stderr == "febkit: there is not enough memory: Unable to allocate 3 TiB\n"
    assert not list(model.parent.glob("febkit-crash-*"))


# ---- printing -------------------------------------------------------------------------------------------
def _wide() -> Table:
    columns = ["", *(f"metric number {k} (a unit)" for k in range(8))]
    return Table("a title", columns, [["cell [1]", *(f"{k}.1234 [{k}.0123, {k}.9876]" for k in range(8))]])


def test_tables_keep_every_digit_and_bracket(capsys: pytest.CaptureFixture[str]) -> None:
    printing.table(_wide())
    out = capsys.readouterr().out
    for k in range(8):
        assert f"{k}.1234 [{k}.0123, {k}.9876]" in out
    assert "cell [1]" in out and "…" not in out and max(map(len, out.splitlines())) > 200
    assert len(out.strip().splitlines()) == 4, "a row is a line where no terminal is"


def test_tables_stand_in_bands_on_a_terminal() -> None:
    text = _wide().text(80)
    assert max(map(len, text.splitlines())) <= 80
    assert text.count("cell [1]") == 4 and all(f"{k}.1234 [{k}.0123, {k}.9876]" in text for k in range(8))
    assert _wide().text(10).count("cell [1]") == 8, "never narrower than a column"


def test_one_way_of_printing() -> None:
    """Verbs print through cli/printing.py, which cuts nothing and reads nothing as markup."""
    for path in sorted((ROOT / "febkit" / "cli").glob("*.py")):
        if path.name not in ("printing.py", "crash.py"):
            text = path.read_text(encoding="utf-8")
            assert not re.search(r"click\.echo|\bprint\(|rich\.(console|table)|Console\(", text), path
