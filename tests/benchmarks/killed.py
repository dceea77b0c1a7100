"""A run killed at 50 random moments: is every announced state there, and the earlier result until there is a new one?

    PYTHONPATH=tests python tests/benchmarks/killed.py [--kills 50] [--seed 0] [--steps 3000]
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from cli.conftest import pulled
from helpers.killed import kill_at_random

if __name__ == "__main__":
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    options.add_argument("--kills", type=int, default=50)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--steps", type=int, default=3000)
    o = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        print(kill_at_random(Path(folder), pulled(steps=7), pulled(steps=o.steps), o.kills, o.seed))
