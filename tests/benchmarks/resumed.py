"""Runs gone on with: are they, bit for bit, what unbroken ones are?

    PYTHONPATH=tests python tests/benchmarks/resumed.py [--kills 6] [--seed 0] [--steps 400] [MODEL.feb ...]

Runs of five kinds, killed at random moments; or models, gone on with from the last step that is a power of two.
"""

from __future__ import annotations

import argparse
import random
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from febkit._version import __version__
from febkit.checkpoint import read, write
from febkit.feb import read as records
from febkit.lower import lower
from febkit.model import InputError
from febkit.solver.checkpoint import Resumed, refusal, taken
from febkit.solver.options import Options
from febkit.solver.run import Listener, Run
from helpers.command import FEBKIT
from helpers.resumed import KINDS, differing, kill_and_go_on


class Keeps(Listener):
    """Writes a checkpoint after 1, 2, 4, ... steps, each over the last; has the end as ``last``."""

    def __init__(self, path: Path) -> None:
        self.path, self.at, self.last = path, 0, {}

    def stepped(self, run: Run) -> None:
        n = run.totals.steps
        if run.over:
            self.last = taken(run)
        elif n & (n - 1) == 0:
            write(self.path, {"febkit": __version__}, taken(run))
            self.at = n


def gone_on(model: str, path: Path) -> str:
    """What became of a model."""
    try:
        problem = lower(records(model))
    except InputError as e:
        return f"not solved: {e}"
    if refusal(problem):
        return refusal(problem)
    ends = []
    for again in (False, True):
        kept = Keeps(path)
        run = Run(problem if not again else lower(records(model)), [kept], Options(threads=1))
        run.remembers = True
        if again:
            run.resumed = Resumed(read(path).run)
        result = run.solve()
        if not result.converged:
            return f"not solved: {result.reason}"
        if not again and not kept.at:
            return "one step"
        ends.append((kept.at, run.totals.steps, kept.last))
    (at, steps, whole), (*_, rest) = ends
    found = differing(whole, rest)
    return f"step {at} of {steps}: " + (f"DIFFERS: {', '.join(found[:4])}" if found else "equal")


def killed(o: argparse.Namespace) -> None:
    rng = random.Random(o.seed)
    for kind in KINDS:
        with tempfile.TemporaryDirectory() as folder:

            def start(*args: str, folder: str = folder) -> Any:
                pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
                return subprocess.Popen([FEBKIT, *args], cwd=folder, **pipes)

            within = kill_and_go_on(Path(folder), kind, o.steps, o.kills, rng, start)
            print(f"{kind}: {o.kills} kills, {within} before the end; final states and plotfiles are equal", flush=True)


if __name__ == "__main__":
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    options.add_argument("models", nargs="*")
    options.add_argument("--kills", type=int, default=6, help="of each kind")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--steps", type=int, default=400)
    o = options.parse_args()
    if not o.models:
        killed(o)
    for model in o.models:
        with tempfile.TemporaryDirectory() as folder:
            print(f"{Path(model).name}: {gone_on(model, Path(folder) / 'c')}", flush=True)
