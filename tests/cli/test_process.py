"""How the process of a command begins and ends."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from helpers import cube
from helpers.command import febkit

COMMAND = "import sys; sys.argv = {args!r}\nfrom febkit.cli.main import command\n{before}\ncommand()"


def _command(*args: str, before: str = "", folder: Path) -> subprocess.CompletedProcess[str]:
    program = COMMAND.format(args=["febkit", *args], before=before)
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=folder)


def test_all_that_was_said_comes_through_a_pipe(tmp_path: Path) -> None:
    """Though the process does not wait for Python to take itself apart."""
    done = febkit("--help", folder=tmp_path)
    assert done.returncode == 0 and done.stdout.endswith("options.\n")
    done = febkit("info", "none.feb", folder=tmp_path)
    assert done.returncode == 2 and "none.feb" in done.stderr


@pytest.mark.parametrize("args", [["--version"], ["info", "none.feb"]])
def test_what_asked_to_be_told_of_the_end_is(args: list[str], tmp_path: Path) -> None:
    code = 0 if args == ["--version"] else 2
    done = _command(*args, before="import atexit; atexit.register(print, 'told')", folder=tmp_path)
    assert done.returncode == code and done.stdout.endswith("told\n")
    thread = "import threading, time; threading.Thread(target=lambda: (time.sleep(0.2), print('done'))).start()"
    done = _command(*args, before=thread, folder=tmp_path)
    assert done.returncode == code and done.stdout.endswith("done\n")


@pytest.mark.parametrize("good", [True, False], ids=["solved", "refused"])
def test_garbage_is_collected_while_a_run_goes_on(good: bool, tmp_path: Path) -> None:
    """Not of what was imported before; and in the process of a caller, whatever became of the run."""
    solid = '<material id="1" name="m" type="neo-Hookean"><E>1</E><v>0.3</v></material>'
    model = cube.text(solid) if good else "<febio_spec version='4.0'/>"
    (tmp_path / "m.feb").write_text(model)
    program = (
        "import gc, febkit.solver.newton as n\n"
        "step, seen = n.Newton.step, []\n"
        "n.Newton.step = lambda *a: (seen.append((gc.isenabled(), gc.get_freeze_count() > 10_000)), step(*a))[1]\n"
        "from febkit.cli.main import cli\n"
        "try:\n    cli.main(['run', 'm.feb', '-silent'], standalone_mode=False)\n"
        "except Exception as e:\n    print(type(e).__name__)\n"
        "print(set(seen), gc.isenabled())"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert done.stdout == ("{(True, True)} True\n" if good else "InputError\nset() True\n"), done.stderr
