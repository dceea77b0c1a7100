"""Runs that are killed at random moments, and what is left of them and of the result before."""

from __future__ import annotations

import random
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from febkit.results.xplt.reader import PlotFile

from . import forked


@dataclass
class Found:
    """How many kills came before the first new state, within the run, and after its end; states that were there."""

    earlier: int = 0
    within: int = 0
    whole: int = 0
    states: int = 0


def states(path: Path) -> int:
    """States of a plotfile, every one of them read."""
    with PlotFile(path) as f:
        for t in range(len(f.states)):
            assert all(np.isfinite(v).all() for i in range(len(f.variables)) for _, v in f.regions(i, t))
        return len(f.states)


def kill_at_random(folder: Path, short: str, long: str, kills: int, seed: int) -> Found:
    """Run the model ``long`` over the result of ``short``, again and again, and kill it by SIGKILL.

    The plotfile must open each time: as the earlier one, byte for byte, or with a state for each step that the log
    announces. Moments are spread evenly over the run, each at random within its share.
    """
    model, plot, log = folder / "m.feb", folder / "m.xplt", folder / "m.log"
    model.write_text(short)
    assert forked.febkit("run", "m.feb", "-silent", folder=folder).returncode == 0
    earlier = plot.read_bytes()
    model.write_text(long)
    start = time.monotonic()
    whole = forked.febkit("run", "m.feb", "-silent", "-p", "whole.xplt", "-o", "whole.log", folder=folder)
    assert whole.returncode == 0, whole.stderr
    seconds, all_states = time.monotonic() - start, states(folder / "whole.xplt")
    rng, found = random.Random(seed), Found()
    for k in range(kills):
        plot.write_bytes(earlier)
        log.write_text("febkit of an earlier run\n")
        job = forked.Job("run", "m.feb", "-silent", folder=folder)
        time.sleep(seconds * (k + rng.random()) / kills)
        job.kill()
        job.communicate()
        if plot.read_bytes() == earlier:
            found.earlier += 1
            assert log.read_text() == "febkit of an earlier run\n"
            continue
        n, announced = states(plot), log.read_text().count("converged at time")
        assert n >= 2, "the earlier result is lost and there is no new state that was solved"
        assert n >= 1 + announced, f"{announced} steps are announced, {n} states are there"
        found.states += n
        if n == all_states:
            found.whole += 1
        else:
            found.within += 1
    return found
