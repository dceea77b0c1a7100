"""Many cell models from one tissue result over a local Dask cluster, one of whose workers is killed half way.

    python tests/benchmarks/points.py [--points 200] [--workers 2]

Checks that every result is there, once, and equal to a serial run; prints the seconds of both.
"""

from __future__ import annotations

import argparse
import contextlib
import tempfile
import time
from pathlib import Path

import numpy as np
import psutil

from febkit import study
from febkit.study.run import Outcome

TEXT = """
cases = ["B"]
methods = ["2"]
control = false
[model]   # gently, so that coarse meshes stand it at every point
depth = 0.02
times = [0.0, 0.1, 1.0, 10.0]
[tissue]
n = 5
vertical = 21
centre = 0.0
[cell]
n = 5
cells = 1
layers = [1, 1, 1]
edge = 0.05
[points]
file = "points.csv"
[run]
workers = {workers}
memory = 4
"""


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--points", type=int, default=200)
    ap.add_argument("--workers", type=int, default=2)
    a = ap.parse_args()
    killed: list[int] = []

    def kill_one(done: int, total: int, outcome: Outcome) -> None:
        if killed or done < total // 2:
            return
        for child in psutil.Process().children(recursive=True):
            with contextlib.suppress(psutil.Error):
                if "spawn_main" in " ".join(child.cmdline()):
                    child.kill()
                    killed.append(child.pid)
                    return

    points = np.random.default_rng(1).uniform(-0.3, 0.3, (a.points, 3))
    with tempfile.TemporaryDirectory() as folder:
        plans = []
        for name in ("cluster", "serial"):
            root = Path(folder) / name
            root.mkdir()
            np.savetxt(root / "points.csv", points, delimiter=",")
            (root / "many.toml").write_text(TEXT.format(workers=a.workers))
            plans.append(study.make_plan(study.read(root / "many.toml")))
        start = time.perf_counter()
        over = study.carry_out(plans[0], "local", kill_one)
        cluster = time.perf_counter() - start
        assert killed, "no worker was found to kill"
        assert over.complete, over.failed
        assert sorted(o.key for o in over.done) == sorted(plans[0].steps()), "a result is missing, or there twice"
        start = time.perf_counter()
        assert study.carry_out(plans[1], "serial").complete
        serial = time.perf_counter() - start
        x, y = (study.results(p) for p in plans)
        for name in x.data_vars:
            np.testing.assert_allclose(x[name], y[name], rtol=1e-8, atol=1e-14, err_msg=str(name))
    print(
        f"{a.points} cell models, {len(over.done)} steps of work, worker {killed[0]} killed half way: all there, once, "
        f"equal to a serial run; {cluster:.0f} s on {a.workers} workers, {serial:.0f} s serial"
    )


if __name__ == "__main__":
    main()
