"""A fit of E, v and k of a plug in unconfined compression: febkit's with derivatives and without, FEBio's levmar.

    python tests/benchmarks/fit_beside.py [--n 8 6] [--febio FEBIO] [--whole]

``--n``: elements over the radius and the height (a quarter of the plug: 3/4 n^2 times the height's). Data are the
model's own forces with 1 % of noise. Processor seconds, one thread each. FEBIO is the command of an FEBio 4; its fit
is run whole with ``--whole``, else one run of the model at the start is timed for each that its method makes (which
does not depend on the mesh: measured by ``--whole`` on a coarse one).
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import febkit
from helpers import specimens

RUNS = 32  # of FEBio's levmar, from this start
START = {"c.solid.E": (0.1, 1.0, 3.0), "c.solid.v": (0.0, 0.3, 0.45), "c.permeability.perm": (1e-4, 6e-3, 1e-1)}


def model(n: tuple[int, int]) -> febkit.Model:
    """The specimen's with other elements, in steps that meet the times of the data: FEBio would be off them."""
    m = specimens._plug(febkit.materials.NeoHookean(E=0.6, v=0.15), n)
    m.prescribe("top", z=-0.1, curve=[(0, 0), (20, 1)])
    times = specimens.SPECIMENS["unconfined"].times
    m.step(time=4000, dt=4, dtmax=500, must_points=times.tolist(), solver=specimens.NEWTON)
    return m


def measured(m: febkit.Model) -> np.ndarray:
    s = specimens.SPECIMENS["unconfined"]
    true = m.copy()
    for path, v in s.truth.items():
        true[path] = v
    r = true.solve(at=s.times, variables=["reaction forces"], threads=1)
    force = r.dataset.febkit.reaction("top").sel(xyz="z").values
    noise = np.random.default_rng(1).normal(size=len(force))
    return np.column_stack([s.times, force + 0.01 * np.abs(force).max() * noise])


def ours(m: febkit.Model, data: np.ndarray, exact: bool) -> tuple[float, Any]:
    began = time.process_time()
    low, first, high = START["c.permeability.perm"]
    where = START | {"c.permeability.perm": febkit.Parameter(low, first, high, log=True)}
    f = febkit.fit(m, where, data, "reaction top z", exact=exact)
    return time.process_time() - began, f


def optimisation(m: febkit.Model, data: np.ndarray) -> str:
    tag = {"c.solid.E": "solid.E", "c.solid.v": "solid.v", "c.permeability.perm": "permeability.perm"}
    params = "\n".join(f"""<param name="fem.material('c').{tag[k]}">{s}, {lo}, {hi}, {s}</param>"""
                       for k, (lo, s, hi) in START.items())  # fmt: skip
    points = "\n".join(f"<point>{t:.10g}, {-f:.10g}</point>" for t, f in data)  # FEBio's Rz is the force on the lid
    return f"""<?xml version="1.0"?>
<febio_optimize version="2.0">
<Options type="levmar"><obj_tol>1e-6</obj_tol><f_diff_scale>0.001</f_diff_scale></Options>
<Parameters>
{params}
</Parameters>
<Objective type="data-fit"><fnc type="filter_sum"><node_data data="Rz" node_set="top"/></fnc>
<data>
{points}
</data></Objective>
</febio_optimize>
"""


def theirs(febio: str, m: febkit.Model, data: np.ndarray, whole: bool) -> tuple[float, int]:
    """Processor seconds and runs."""
    start = m.copy()
    for path, (_, v, _) in START.items():
        start[path] = v
    with tempfile.TemporaryDirectory() as folder:
        start.write(Path(folder) / "plug.feb")
        (Path(folder) / "fit.feb").write_text(optimisation(m, data))
        command = [febio, "-i", "plug.feb", *(("-s", "fit.feb") if whole else ())]
        env = {**os.environ, "OMP_NUM_THREADS": "1"}
        p = subprocess.Popen(command, cwd=folder, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, use = os.wait4(p.pid, 0)
        p.returncode = os.waitstatus_to_exitcode(status)
        assert p.returncode == 0, sorted(os.listdir(folder))
        spent = use.ru_utime + use.ru_stime
        if not whole:
            return RUNS * spent, RUNS
        text = "".join(q.read_text(errors="replace") for q in Path(folder).glob("*.log"))
        return spent, len(re.findall(r"^objective value", text, re.M))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, nargs=2, default=(8, 6))
    parser.add_argument("--febio", default=os.environ.get("FEBIO"))
    parser.add_argument("--whole", action="store_true")
    given = parser.parse_args()
    m = model(tuple(given.n))
    data = measured(m)
    print(sum(len(b.ids) for b in m.mesh.blocks), "elements")
    for exact in (True, False):
        spent, f = ours(m, data, exact)
        print(f"{'derivatives' if exact else 'differences'}: {spent:.1f} s, {f.runs} runs,",
              ", ".join(f"{v:.6g}" for v in f.values.values()), flush=True)  # fmt: skip
    if given.febio:
        spent, runs = theirs(given.febio, m, data, given.whole)
        print(f"FEBio: {spent:.1f} s, {runs} runs")


if __name__ == "__main__":
    main()
