"""Writes checkpoints of a run as it goes on, once everything else is written."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import monotonic
from typing import Protocol, runtime_checkable

from febkit.checkpoint import Plan, write
from febkit.files import Mark
from febkit.solver.checkpoint import taken
from febkit.solver.result import Result
from febkit.solver.run import Listener, Run


@runtime_checkable
class Writes(Protocol):
    """A listener that writes files, ``what`` they are."""

    what: str

    def marks(self) -> list[Mark | None]: ...


class CheckpointListener(Listener):
    """``writers``: the listeners that write files.

    A checkpoint that cannot be written is warned of, once, and the run goes on. One that has served is removed.
    """

    def __init__(self, plan: Plan, writers: Sequence[Writes], warn: Callable[[str], None]) -> None:
        assert plan.path is not None and plan.every is not None
        self.path, self.every, self.head, self.writers, self.warn = plan.path, plan.every, plan.head, writers, warn
        self._last, self._steps, self._said = monotonic(), 0, False

    def start(self, run: Run) -> None:
        self._steps = run.resumed.steps if run.resumed is not None else 0

    def stepped(self, run: Run) -> None:
        over = self.every.keep and run.over
        late = bool(self.every.seconds) and monotonic() - self._last >= self.every.seconds
        if over or late or (self.every.steps and run.totals.steps - self._steps >= self.every.steps):
            self._write(run)
            self._last, self._steps = monotonic(), run.totals.steps

    def _write(self, run: Run) -> None:
        try:
            marks = {w.what: w.marks() for w in self.writers}
            write(self.path, {**self.head, "files": marks}, taken(run))
        except OSError as e:
            if not self._said:
                self.warn(f"no checkpoint was written at time {run.state.time:g}: {self.path}: {e.strerror}")
            self._said = True

    def end(self, run: Run, result: Result) -> None:
        if result.converged and not self.every.keep:
            self.path.unlink(missing_ok=True)
