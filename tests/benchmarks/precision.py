"""Work against precision: error and seconds over mesh, step size and tolerance, febkit's routes beside FEBio's runs.

    python tests/benchmarks/precision.py confined [-o picture.png]
    python tests/benchmarks/precision.py tissue15_B [--models ../shared/oracle/bench] [-o picture.png]
    python tests/benchmarks/precision.py cell_small --tight 1e-5 --finer 1 2 4 \\
        --accuracies 1e-2 3e-3 1e-3 3e-4 1e-4 [-o picture.png]

``confined``: ramp and hold of a confined column against the series of Mow et al. (1980), error of the reaction.
Others: a model of the benchmark folder on its own mesh against a solution of the same mesh by second-order steps of a
small error (--tight), which FEBio's stored run is measured against as well; the file's steps are divided by --finer.
Errors are the largest relative L2 errors of u and p over the stored times.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[1]))  # run as a script: helpers are beside the benchmarks
DEFAULT = HERE.parents[2].parent / "shared" / "oracle" / "bench"
ACCURACIES = (1e-2, 3e-3, 1e-3, 3e-4)
Row = tuple[str, int, float, float, float]  # route, steps, seconds, error of u (or of the reaction), error of p


def confined() -> list[Row]:
    """Meshes of 10, 20 and 40 elements; equal steps and steps of their own size."""
    from febkit.solver.options import Options
    from febkit.solver.problem import AutoStep
    from febkit.solver.run import run
    from helpers import scenes
    from helpers.files import load

    exact = load(HERE.parents[1] / "solver" / "test_analytic.py")

    def solve(n: int, steps: int, accuracy: float) -> Row:
        top = -1e-6
        p = scenes.column(n, exact.E, exact.V, exact.K, top=top, grading=1.6)
        s = p.steps[0]
        s.dt, s.count = 2.0 / steps, steps
        if accuracy:
            s.dt, s.auto = 1e-4, AutoStep(must_points=(0.5, 1.0, 1.5, 2.0))
            s.duration = 2.0
        nodes = np.flatnonzero(p.X[:, 2] > 1 - 1e-9)
        h = exact.History(lambda r: r.state.reaction[nodes, 2].sum())
        start = time.perf_counter()
        r = run(p, [h], Options(threads=1, accuracy=accuracy))
        seconds = time.perf_counter() - start
        assert r.converged, r.reason
        t, force = np.array(h.t), np.array(h.values)
        expected = exact.relaxation(t, top, 1.0)
        seen = np.isclose(t[:, None], [0.5, 1.0, 1.5, 2.0], rtol=1e-9).any(axis=1)
        error = float(np.abs(force / 0.01 - expected)[seen].max() / np.abs(expected).max())
        route = "second order" if accuracy else "backward Euler"
        return f"{n} elements, {route}", r.totals.steps, seconds, error, 0.0

    solve(10, 20, 0.0), solve(10, 20, 1e-2)  # compile
    rows = []
    for n in (10, 20, 40):
        rows += [solve(n, steps, 0.0) for steps in (20, 80, 320, 1280)]
        rows += [solve(n, 20, a) for a in (*ACCURACIES, 1e-4, 1e-5)]
    return rows


def model(folder: Path, name: str, tight: float, threads: int, finer: list[int], accuracies: list[float]) -> list[Row]:
    """The file's steps (fresh and kept factorisations, divided), second-order steps, and FEBio's recorded run."""
    import febkit
    from febkit.lower import lower
    from febkit.output.plotfile import PlotListener
    from febkit.solver.options import Options
    from febkit.solver.run import run

    m = febkit.read(folder / "models" / f"{name}.feb").record
    stored = np.load(folder / "reference" / f"{name}.npz")
    times = stored["times"]

    def solve(divided: int = 1, **options: Any) -> tuple[int, float, Any, Any]:
        problem = lower(m)
        divide(problem, divided)
        with tempfile.TemporaryDirectory() as out:
            plot = Path(out) / "run.xplt"
            start = time.perf_counter()
            r = run(problem, [PlotListener(m, plot, warnings.warn)], Options(threads=threads, **options))
            seconds = time.perf_counter() - start
            assert r.converged, r.reason
            ds = febkit.open_results(plot)
            at = [int(np.argmin(np.abs(ds["time"].values - t))) for t in times]
            assert np.allclose(ds["time"].values[at], times)
            u, p = (ds[v].values[at] for v in ("displacement", "effective_fluid_pressure"))
        t = r.totals
        print(f"{options} / {divided}: {t.steps} steps, {t.retries} retries, {t.iterations} iterations, "
              f"{t.reforms} factorisations, {seconds:.1f} s", file=sys.stderr, flush=True)  # fmt: skip
        return t.steps, seconds, u, np.nan_to_num(p)

    _, _, u0, p0 = solve(accuracy=tight)

    def row(route: str, steps: int, seconds: float, u: Any, p: Any) -> Row:
        errors = []
        for a, b in ((u, u0), (np.nan_to_num(p), p0)):
            size = np.array([np.linalg.norm(x) for x in b])
            errors.append(max(np.linalg.norm(x - y) / max(s, 1e-3 * size.max()) for x, y, s in zip(a, b, size)))
        return route, steps, seconds, float(errors[0]), float(errors[1])

    known = json.loads((folder / "febio.json").read_text())[name]
    rows = [row("FEBio, recorded", known["steps"], known["seconds"], stored["u"], stored["p"])]
    for k in finer:
        steps = "FEBio's steps" if k == 1 else f"FEBio's steps / {k}"
        rows.append(row(steps, *solve(k, factor="fresh")))
        rows.append(row(f"{steps}, factorisations kept", *solve(k)))
    rows += [row(f"second order, {a:g}", *solve(accuracy=a)) for a in accuracies if a > tight]
    return rows


def divide(problem: Any, by: int) -> None:
    """Divide the step sizes of FEBio's time stepper; must points stay."""
    for s in problem.steps:
        if by > 1 and s.auto is not None:
            s.duration = s.duration or s.dt * s.count
            largest = s.auto.dtmax_curve
            s.dt, s.auto.dtmin, s.auto.dtmax = s.dt / by, s.auto.dtmin / by, s.auto.dtmax / by
            if largest is not None:
                s.auto.dtmax_curve = lambda t, f=largest: f(t) / by


def draw(rows: list[Row], title: str, out: Path) -> None:
    """Error against seconds; one line per family of routes."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, ax = plt.subplots(figsize=(7, 4.5))
    families: dict[str, list[Row]] = {}
    for r in rows:
        name = r[0].rsplit(", ", 1)[0] if r[0].startswith("second") else re.sub(" / [0-9]+", "", r[0])
        families.setdefault(name, []).append(r)
    mesh = {n: n.split(",")[0] if "elements" in n else n for n in families}  # one colour for a mesh, else for a route
    colours = {m: f"C{i}" for i, m in enumerate(dict.fromkeys(mesh.values()))}
    for name, some in families.items():
        mark = "o--" if name.endswith("backward Euler") else "o-" if len(some) > 1 else "s"
        mark = "*" if "FEBio, rec" in name else mark
        ax.loglog([r[2] for r in some], [max(r[3], r[4]) for r in some], mark, label=name,
                  color="k" if "FEBio, rec" in name else colours[mesh[name]], markersize=6)  # fmt: skip
    ax.set(xlabel="seconds", ylabel="relative error (larger of u and p)", title=title)
    ax.grid(True, which="both", alpha=0.3)
    ax.legend(fontsize=8)
    fig.tight_layout()
    fig.savefig(out, dpi=150)


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("scene")
    ap.add_argument("--models", type=Path, default=DEFAULT)
    ap.add_argument("--tight", type=float, default=3e-5)
    ap.add_argument("--finer", type=int, nargs="+", default=[1])
    ap.add_argument("--accuracies", type=float, nargs="+", default=ACCURACIES)
    ap.add_argument("--threads", type=int, default=2)
    ap.add_argument("-o", "--output", type=Path)
    a = ap.parse_args()
    warnings.simplefilter("ignore")
    rows = confined() if a.scene == "confined" else model(a.models, a.scene, a.tight, a.threads, a.finer, a.accuracies)
    print("| route | steps | seconds | error of u or the reaction | error of p |\n|---|---|---|---|---|")
    for route, steps, seconds, eu, ep in rows:
        print(f"| {route} | {steps} | {seconds:.2f} | {eu:.1e} | {ep:.1e} |")
    if a.output:
        draw(rows, a.scene, a.output)


if __name__ == "__main__":
    main()
