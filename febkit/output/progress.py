"""A progress bar: time, step, Newton state and the time left."""

from __future__ import annotations

import sys
import time
from typing import Any

from febkit.solver import cache
from febkit.solver.newton import Counts, Iteration
from febkit.solver.result import Result
from febkit.solver.run import Listener, Run


class ProgressListener(Listener):
    """One bar over the analysis time of all steps, drawn on stderr; plain lines where it is no terminal."""

    def __init__(self, title: str) -> None:
        self.title = title
        self._bar: Any = None
        self._task: Any = None
        self._said = 0.0
        self._opened, self._kernels = False, 0

    def compiling(self, run: Run, kernel: str) -> None:
        """Said once where there is no terminal, else kernel by kernel."""
        self._open(run)
        self._kernels += 1
        once = ", once on this machine" if cache.keeps() else ""
        if self._bar is not None:
            self._show(f"compiling kernel {self._kernels} ({kernel}){once}")
        elif self._kernels == 1:
            print(f"{self.title}: compiling the kernels that it needs{once}", file=sys.stderr, flush=True)

    def start(self, run: Run) -> None:
        self._open(run)

    def _open(self, run: Run) -> None:
        """Draw the bar, unless it is there: kernels may be compiled before the run has started."""
        if self._opened:
            return
        self._opened = True
        self._said = time.monotonic()  # a run of seconds says nothing on its way
        self._total = sum(
            s.duration if s.duration is not None else s.dt * s.count for s in run.problem.steps
        )
        if not sys.stderr.isatty():
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

        console = Console(stderr=True)
        if not console.is_terminal:
            return
        self._bar = Progress(
            TextColumn("{task.description}", markup=False), BarColumn(), TaskProgressColumn(), TimeRemainingColumn(),
            TextColumn("{task.fields[state]}", markup=False), console=console,
        )  # fmt: skip
        self._task = self._bar.add_task(self.title, total=self._total, state="")
        self._bar.start()

    def begin_step(self, run: Run, number: int, t: float) -> None:
        self._step = run.totals.steps + 1
        self._show(f"step {self._step}  t = {t:.4g}")

    def iteration(self, run: Run, it: Iteration) -> None:
        name = run.state.layout.fields[0].name
        u = it.norms[name]
        ratio = (u.now / u.required) ** 0.5 if u.required > 0 else 0.0
        self._show(f"step {self._step}  t = {it.time:.4g}  iteration {it.number}  |du|/tol = {ratio:.1e}")

    def _show(self, state: str) -> None:
        if self._bar is not None:
            self._bar.update(self._task, state=state)

    def converged(self, run: Run, counts: Counts) -> None:
        if self._bar is not None:
            self._bar.update(self._task, completed=run.state.time)
        elif time.monotonic() - self._said > 10.0:
            self._said = time.monotonic()
            done = 100.0 * run.state.time / self._total if self._total else 100.0
            print(f"{self.title}: {done:5.1f} %  step {run.totals.steps}  t = {run.state.time:.4g}", file=sys.stderr)

    def end(self, run: Run, result: Result) -> None:
        if self._bar is not None:
            self._bar.stop()
