"""Cost against size: seconds and peak memory of the parts of a solve, from 1e3 to 6e5 unknowns, on 1 and 2 threads.

    python tests/benchmarks/scale.py [--sizes 6 13 20 28 42 53] [--threads 1 2] [--linear auto iterative] [-o scale.png]

A cube of n^3 biphasic neo-Hookean hexahedra, confined, pressed by 1 % from its drained top and solved over four steps
with kept factorisations (a whole run, set-up to end); before it the parts of one tangent are timed: assembly, stresses
and residual, factorisation, solve (in single precision, as such runs keep them). Each row is a process of its own, for
its peak memory; none follows one that took more than --limit seconds. Below the table: growth exponents of a kind's
last two sizes, d log(cost) / d log(unknowns).
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[1]))  # run as a script: helpers are beside the benchmarks
PARTS = ("analysis", "factor", "solve", "tangent", "residual", "run", "MB")


def problem(n: int) -> Any:
    """The cube, with FEBio's default tolerances and steps of its stepper up to must points."""
    from febkit.solver.permeabilities.const_iso import ConstIso
    from febkit.solver.physics.biphasic import Biphasic
    from febkit.solver.problem import TRANSIENT, AutoStep, Fixed, Prescribed, Problem, Step
    from febkit.solver.solids.neo_hookean import NeoHookean
    from helpers import scenes
    from helpers.scenes import UX, UY, UZ, P

    X, conn = scenes.grid((n, n, n))
    top = np.flatnonzero(X[:, 2] > 1 - 1e-9)
    sides: list[Any] = [Fixed(c, np.flatnonzero(np.abs(X[:, c] - 0.5) > 0.5 - 1e-9)) for c in (UX, UY)]
    conditions = [
        *sides, Fixed(UZ, np.flatnonzero(X[:, 2] < 1e-9)), Fixed(P, top), Prescribed(UZ, top, scenes.ramp(-0.01, 0.1))
    ]  # fmt: skip
    auto = AutoStep(dtmax=0.05, dtmin=0.0, must_points=(0.05, 0.1, 0.15, 0.2))
    step = Step(analysis=TRANSIENT, dt=0.05, duration=0.2, auto=auto, conditions=conditions)
    step.saving.level = "PLOT_MUST_POINTS"
    return Problem(X, [scenes.block("hex8", conn, NeoHookean(E=1.0, v=0.125), Biphasic(ConstIso(0.02)))], [step])


def measure(n: int, threads: int, linear: str) -> dict[str, float]:
    """One row, in this process."""
    import resource

    from febkit.solver.options import Options
    from febkit.solver.route import Route
    from febkit.solver.run import Run, run
    from febkit.solver.system import System

    out: dict[str, float] = {}

    def timed(name: str, work: Any, times: int = 3) -> None:
        seconds = []
        for _ in range(times):
            start = time.perf_counter()
            work()
            seconds.append(time.perf_counter() - start)
        out[name] = min(seconds)

    r = Run(problem(n), [], Options(threads=threads, linear=linear))
    r._set_up()
    system = r.system = System(r.problem, r.problem.steps[0], r.groups, r.state, r.schedule)
    r.state.dt = r.state.time = 0.05
    step = np.zeros(system.eqs.n)
    system.tangent(step)
    timed("tangent", lambda: system.tangent(step))
    timed("residual", lambda: (system.update(), system.residual()))
    A, _ = system.tangent(step)
    route = Route(system, r.options, threads)
    solver = route.solver(linear, single=route.keeps())
    timed("analysis", lambda: solver.factor(A), 1)
    timed("factor", lambda: solver.factor(A), 2 if n < 40 else 1)
    out["analysis"] = max(out["analysis"] - out["factor"], 0.0)
    b = np.random.default_rng(0).standard_normal(A.n)
    timed("solve", lambda: solver.solve(b))
    out["unknowns"] = A.n
    solver.close()
    r.team.close()
    start = time.perf_counter()
    result = run(problem(n), [], Options(threads=threads, linear=linear))
    assert result.converged, result.reason
    out["run"] = time.perf_counter() - start
    out["factorisations"] = result.totals.reforms
    out["MB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return out


def row(n: int, threads: int, linear: str) -> dict[str, float]:
    """One row, in a process of its own."""
    command = [sys.executable, str(HERE), "--one", str(n), str(threads), linear]
    env = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(command, capture_output=True, text=True, env=env, check=False)
    if done.returncode:
        raise SystemExit(done.stderr[-2000:])
    return dict(json.loads(done.stdout.splitlines()[-1]))


def exponents(rows: list[dict[str, float]]) -> str:
    a, b = rows[-2], rows[-1]
    grown = np.log(b["unknowns"] / a["unknowns"])
    parts = [p for p in PARTS if a.get(p, 0) > 0 and b.get(p, 0) > 0]
    return ", ".join(f"{p} {np.log(b[p] / a[p]) / grown:.2f}" for p in parts)


def draw(found: dict[tuple[str, int], list[dict[str, float]]], out: Path) -> None:
    """Seconds of a run and of its parts, and memory, against unknowns."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, axes = plt.subplots(1, 3, figsize=(12, 4))
    for i, ((linear, threads), rows) in enumerate(found.items()):
        name, x = "direct" if linear == "auto" else linear, [r["unknowns"] for r in rows]
        label = f"{name}, {threads} thread{'s' * (threads > 1)}"
        axes[0].loglog(x, [r["run"] for r in rows], "o-", color=f"C{i}", label=label)
        axes[1].loglog(x, [r["factor"] for r in rows], "o-", color=f"C{i}", label=f"{label}: factor")
        axes[1].loglog(x, [r["solve"] for r in rows], "s--", color=f"C{i}", label="solve")
        axes[2].loglog(x, [r["MB"] for r in rows], "o-", color=f"C{i}", label=label)
    for ax, title in zip(axes, ("whole run, s", "one factorisation or set-up, one solve; s", "peak memory, MB")):
        ax.set(xlabel="unknowns", title=title)
        ax.grid(True, which="both", alpha=0.3)
        ax.legend(fontsize=7)
    fig.tight_layout()
    fig.savefig(out, dpi=150)


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--sizes", type=int, nargs="*", default=[6, 13, 20, 28, 42, 53])
    ap.add_argument("--threads", type=int, nargs="*", default=[1, 2])
    ap.add_argument("--linear", nargs="*", default=["auto"])
    ap.add_argument("--limit", type=float, default=100.0, help="seconds of a row after which no larger one is tried")
    ap.add_argument("--one", nargs=3, help=argparse.SUPPRESS)
    ap.add_argument("-o", "--output", type=Path)
    a = ap.parse_args()
    if a.one:
        print(json.dumps(measure(int(a.one[0]), int(a.one[1]), a.one[2])))
        return
    print("| linear | threads | unknowns | tangent | stresses, residual | analysis | factor | solve | run | MB |")
    print("|---" * 10 + "|")
    found: dict[tuple[str, int], list[dict[str, float]]] = {}
    for linear in a.linear:
        for threads in a.threads:
            spent = 0.0
            for n in a.sizes:
                if spent > a.limit:
                    break
                start = time.perf_counter()
                r = row(n, threads, linear)
                spent = time.perf_counter() - start
                found.setdefault((linear, threads), []).append(r)
                cells = " | ".join(f"{r[k]:.3g}" for k in ("tangent", "residual", "analysis", "factor", "solve", "run"))
                print(f"| {linear} | {threads} | {r['unknowns']:.0f} | {cells} | {r['MB']:.0f} |", flush=True)
    for (linear, threads), rows in found.items():
        if len(rows) > 1:
            print(f"\n{linear}, {threads} thread{'s' * (threads > 1)}: {exponents(rows)}")
    if a.output:
        draw(found, a.output)


if __name__ == "__main__":
    main()
