"""A solve that takes several sittings: its files lie in a folder that outlives an interrupted study."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from febkit import checkpoint
from febkit.model import InputError

if TYPE_CHECKING:
    from febkit.solver.result import Result

SINCE = "since"  # seconds of earlier sittings, and when this one began


def solve(run: Callable[..., Result], folder: Path, names: tuple[str, str], every: str) -> tuple[Result, float, str]:
    """``run(plotfile, log, checkpoint=, resume=)`` in ``folder``, from its checkpoint where there is one that serves.

    Returns the result, the seconds that earlier sittings took to that checkpoint, and why it was begun anew, if so.
    The folder is left for a later sitting where the run is interrupted or the process dies.
    """
    plot, log = (folder / n for n in names)
    saved, why = checkpoint.beside(plot), ""
    if saved.exists():
        try:
            checkpoint.read(saved)
        except InputError as e:
            why = f"begun anew: {e}"
    resume = saved.exists() and not why
    before = _before(folder, saved) if resume else 0.0
    if not resume:
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / SINCE).write_text(f"{before!r} {time.time()!r}")
    return run(plot, log, checkpoint=every, resume=resume), before, why


def _before(folder: Path, saved: Path) -> float:
    """Seconds until the checkpoint was written, over all sittings; what was lost with a process does not count."""
    try:
        spent, since = map(float, (folder / SINCE).read_text().split())
    except (OSError, ValueError):
        return 0.0
    return spent + max(saved.stat().st_mtime - since, 0.0)
