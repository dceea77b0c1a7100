"""Runs of five kinds killed at random moments and gone on with: are they, bit for bit, what unbroken ones are?

    PYTHONPATH=tests python tests/benchmarks/resumed.py [--kills 6] [--seed 0] [--steps 400]
"""

from __future__ import annotations

import argparse
import random
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from helpers.command import FEBKIT
from helpers.resumed import KINDS, kill_and_go_on

if __name__ == "__main__":
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    options.add_argument("--kills", type=int, default=6, help="of each kind")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--steps", type=int, default=400)
    o = options.parse_args()
    rng = random.Random(o.seed)
    for kind in KINDS:
        with tempfile.TemporaryDirectory() as folder:

            def start(*args: str, folder: str = folder) -> Any:
                pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
                return subprocess.Popen([FEBKIT, *args], cwd=folder, **pipes)

            within = kill_and_go_on(Path(folder), kind, o.steps, o.kills, rng, start)
            print(f"{kind}: {o.kills} kills, {within} before the end; final states and plotfiles are equal", flush=True)
