"""``febkit`` in a process of its own, forked off one that has imported what verbs import: without a second of imports.

For tests of what a verb does. Those of what it imports, and one of each verb, start the command as a user does
(:mod:`.command`), and so do all where processes cannot be forked.
"""

from __future__ import annotations

import atexit
import multiprocessing
import os
import subprocess
import sys
import traceback
from collections.abc import Mapping
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from febkit.cli.main import VERBS

# not numba, which is imported when a kernel is compiled
PRELOADED = [
    *(f"febkit.cli.{verb}" for verb in VERBS),
    *(f"febkit.{name}" for name in (
        "feb.validation", "feb.writer", "lower", "solving", "solver.run", "solver.newton", "solver.linear.dense",
        "output.log", "output.plotfile", "output.progress", "results.dataset", "results.fields", "results.netcdf",
        "results.accessor", "metrics.cells", "metrics.summary", "metrics.agreement", "coupling.driving", "study.report",
        "study.work", "templates.template", "plots.history",
    )),
    "dask.array", "distributed", "llvmlite.binding", "lxml.etree", "matplotlib.backends.backend_agg",
    "matplotlib.pyplot", "netCDF4", "rich.console", "rich.table", "scipy.sparse", "scipy.stats", "xarray",
]  # fmt: skip


class Job:
    """``febkit *args`` at work in ``folder``; ``before`` is code that its process runs first. As a ``Popen``."""

    def __init__(self, *args: str | Path, folder: Path, env: Mapping[str, str] | None = None, before: str = "") -> None:
        server = multiprocessing.get_context("forkserver")
        server.set_forkserver_preload(PRELOADED)
        (out, to_out), (err, to_err) = server.Pipe(duplex=False), server.Pipe(duplex=False)
        self.args = ["febkit", *(str(a) for a in args)]
        self._pipes = out, err
        self._process = server.Process(
            target=_verb, args=(self.args, str(folder), {**os.environ, **(env or {})}, before, to_out, to_err)
        )
        self._process.start()
        to_out.close()
        to_err.close()
        assert self._process.pid is not None
        self.pid: int = self._process.pid

    @property
    def returncode(self) -> int | None:
        return self._process.exitcode

    def poll(self) -> int | None:
        return self._process.exitcode

    def kill(self) -> None:
        self._process.kill()

    def send_signal(self, number: int) -> None:
        os.kill(self.pid, number)

    def communicate(self, timeout: float | None = 120.0) -> tuple[str, str]:
        """Wait for the end: what was said on both streams (no more than a pipe holds: verbs say little)."""
        self._process.join(timeout)
        if self._process.exitcode is None:
            self.kill()
            self._process.join()
            raise subprocess.TimeoutExpired(self.args, timeout or 0.0)
        out, err = (_read(p) for p in self._pipes)
        return out, err


def febkit(*args: str | Path, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run ``febkit *args``, as :func:`helpers.command.febkit`."""
    job = Job(*args, **options)
    out, err = job.communicate()
    assert job.returncode is not None
    return subprocess.CompletedProcess(job.args, job.returncode, out, err)


def _read(pipe: Connection) -> str:
    with open(os.dup(pipe.fileno()), encoding="utf-8") as f:
        pipe.close()
        return f.read()


def _verb(args: list[str], folder: str, env: dict[str, str], before: str, out: Connection, err: Connection) -> None:
    """In the child: the streams, the folder and the environment of a command; then what its entry point does."""
    atexit._clear()
    for pipe, number in ((out, 1), (err, 2)):
        os.dup2(pipe.fileno(), number)
        pipe.close()
    sys.stdout, sys.stderr = (os.fdopen(n, "w", encoding="utf-8", closefd=False) for n in (1, 2))
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(env)
    sys.argv = args
    try:
        exec(before, {})
        from febkit.cli.main import main

        main()
    except Exception:
        traceback.print_exc()
        raise SystemExit(1) from None
    finally:
        atexit._run_exitfuncs()
