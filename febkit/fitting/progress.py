"""A line that says how a fit goes: runs, the best sum of squares and its parameters."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

from .problem import Trial

OFTEN = 10.0  # s between lines where there is no terminal


class Progress:
    """Drawn on stderr; plain lines now and then where it is no terminal. ``also`` hears of each trial too."""

    def __init__(self, names: Sequence[str], also: Callable[[Trial], None] | None = None) -> None:
        self.names, self.also = names, also
        self.best: Trial | None = None
        self._bar: Any = None
        self._said = time.monotonic()

    def __enter__(self) -> Progress:
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import Progress as Bar
            from rich.progress import SpinnerColumn, TextColumn, TimeElapsedColumn

            self._bar = Bar(SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn(),
                            console=Console(stderr=True), transient=True)  # fmt: skip
            self._task = self._bar.add_task("fitting", total=None)
            self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def trial(self, t: Trial) -> None:
        if self.also is not None:
            self.also(t)
        if math.isfinite(t.objective) and (self.best is None or t.objective < self.best.objective):
            self.best = t
        if self._bar is not None:
            self._bar.update(self._task, description=self._line(t))
        elif time.monotonic() - self._said > OFTEN:
            self._said = time.monotonic()
            print(self._line(t), file=sys.stderr, flush=True)

    def _line(self, t: Trial) -> str:
        if self.best is None:
            return f"trial {t.number}: {t.failure}"
        values = ", ".join(f"{n.rsplit('.', 1)[-1]} = {v:.4g}" for n, v in zip(self.names, self.best.values))
        return f"trial {t.number}: best sum of squares {self.best.objective:.6g} at {values}"
