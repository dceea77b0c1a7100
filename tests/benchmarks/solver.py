"""Time, memory and error of whole runs beside FEBio's recorded ones; memory of the factorisation.

    python tests/benchmarks/solver.py [--models ../shared/oracle/bench] [--only tissue15_B cell_small]
    python tests/benchmarks/solver.py --factor tissue25_B
    python tests/benchmarks/solver.py --loops tissue25_B      element loops beside FEBio's, and all against the machine

A model's folder holds ``models/*.feb``, ``reference/*.npz`` (FEBio's nodal u and p) and ``febio.json``
(FEBio's seconds and peak memory on two threads). Prints a Markdown table; errors are relative, the
largest over the stored states, against FEBio's run at its default tolerances.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as febkit run has it: threads are its own

import numpy as np

HERE = Path(__file__).resolve()
DEFAULT = HERE.parents[2].parent / "shared" / "oracle" / "bench"


def measured(model: Path, out: Path, threads: int) -> tuple[float, float, Path]:
    """(seconds, peak MB, plotfile) of one `febkit run` in a process of its own."""
    plot = out / f"{model.stem}.xplt"
    command = [sys.executable, "-m", "febkit.cli.main", "run", str(model), "-p", str(plot), "-o", str(out / "log")]
    start = time.perf_counter()
    process = subprocess.Popen([*command, "-silent", "-t", str(threads)])
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    if status:
        raise SystemExit(f"{model}: febkit run ended with status {status}")
    return seconds, usage.ru_maxrss / 1024, plot


def errors(plot: Path, reference: Path) -> tuple[float, float]:
    """Largest relative L2 errors of u and p over the states of the reference."""
    import febkit

    ref, ds = np.load(reference), febkit.open_results(plot)
    u, p = ds["displacement"].values, ds["effective_fluid_pressure"].values
    out = [0.0, 0.0]
    floor = 1e-3 * np.nanmax(np.abs(ref["p"])) * np.sqrt(ref["p"].shape[1])
    for i, t in enumerate(ref["times"]):
        k = int(np.argmin(np.abs(ds["time"].values - t)))
        out[0] = max(out[0], np.linalg.norm(u[k] - ref["u"][i]) / max(np.linalg.norm(ref["u"][i]), 1e-12))
        out[1] = max(out[1], np.linalg.norm(np.nan_to_num(p[k] - ref["p"][i])) / max(np.linalg.norm(np.nan_to_num(ref["p"][i])), floor))  # noqa: E501
    return out[0], out[1]


def factor_memory(model: Path) -> None:
    """Bytes and entries of LDL^T of the first tangent, and of LU of the same matrix in full storage."""
    from scipy.sparse import csr_matrix, triu

    import febkit
    from febkit.lower import lower
    from febkit.solver.group import Group
    from febkit.solver.linear.base import Matrix
    from febkit.solver.linear.pardiso import Pardiso
    from febkit.solver.schedule import Schedule
    from febkit.solver.state import State
    from febkit.solver.system import System
    from febkit.solver.threads import Team

    problem, team = lower(febkit.read(model)), Team(2)
    state = State.at_rest(problem)
    state.dt = state.time = problem.steps[0].dt
    groups = [Group(b, problem.X, layout=state.layout) for b in problem.blocks]
    system = System(problem, problem.steps[0], groups, state, Schedule(groups, team))
    system.update()
    A, _ = system.tangent(np.zeros(system.eqs.n))
    upper = csr_matrix((A.data, A.indices, A.indptr), shape=(A.n, A.n))
    both = (upper + triu(upper, 1).T).tocsr()
    both.sort_indices()
    full = Matrix(both.indptr.astype(np.int32), both.indices.astype(np.int32), both.data, False)
    found = {}
    for name, matrix in (("LDL^T", A), ("LU", full)):
        solver = Pardiso(2, mixed=True)
        start = time.perf_counter()
        solver.factor(matrix)
        analysis = time.perf_counter() - start
        start = time.perf_counter()
        solver.factor(matrix)
        found[name] = solver.stats
        print(
            f"{name:6s} {A.n} equations, {solver.stats['factor_entries']:.4g} factor entries, "
            f"{solver.stats['factor_kB'] / 1024:.0f} MB, analysis and first factor {analysis:.2f} s, "
            f"factor {time.perf_counter() - start:.2f} s"
        )
        solver.close()
    print(f"LDL^T / LU memory: {found['LDL^T']['factor_kB'] / found['LU']['factor_kB']:.2f}")


def loops(folder: Path, name: str, threads: int) -> None:
    """Milliseconds of one tangent, stress update and residual, beside FEBio's mean of its run."""
    import febkit
    from febkit.lower import lower
    from febkit.solver.options import Options
    from febkit.solver.run import Run
    from febkit.solver.system import System

    def best(work: Callable[[], object]) -> float:
        work()
        seconds = []
        for _ in range(7):
            start = time.perf_counter()
            work()
            seconds.append(time.perf_counter() - start)
        return 1e3 * min(seconds)

    problem = lower(febkit.read(folder / "models" / f"{name}.feb"))
    run = Run(problem, [], Options(threads=threads))
    run._set_up()
    system = System(problem, problem.steps[0], run.groups, run.state, run.schedule)
    run.state.dt = run.state.time = problem.steps[0].dt
    step = np.zeros(system.eqs.n)
    ours = {"tangent": best(lambda: system.tangent(step)), "update and residual": best(system.update)
            + best(system.residual)}  # fmt: skip
    known = json.loads((folder / "febio.json").read_text())[name]
    split = known["split_s"]
    theirs = {
        "tangent": 1e3 * split["evaluating stiffness"] / known["reforms"],
        "update and residual": 1e3 * (split["model update"] + split["evaluating residual"]) / known["rhs"],
    }
    limits(system, step, best, threads)
    for what, ms in ours.items():
        each = 1e3 * ms / known["elements"]
        print(f"{name}, {what}: {ms:.1f} ms ({each:.2f} us an element), FEBio {theirs[what]:.0f} ms: "
              f"{theirs[what] / ms:.1f} times")  # fmt: skip


def limits(system: Any, step: Any, best: Callable[[Callable[[], object]], float], threads: int) -> None:
    """Factorisation, solve and assembly against this machine: products of matrices, and reading of memory."""
    from concurrent.futures import ThreadPoolExecutor

    from febkit.solver.linear.pardiso import Pardiso

    pool, n = ThreadPoolExecutor(threads), 2048
    work = [np.random.default_rng(i).random((n, n), np.float32) for i in range(threads)]
    flops = threads * 2e-6 * n**3 / best(lambda: list(pool.map(lambda a: a @ a, work)))  # GFlop/s
    field = [np.ones(25_000_000, np.float32) for _ in range(threads)]
    reading = threads * 0.1e3 / best(lambda: list(pool.map(lambda a: a.sum(), field)))  # GB/s
    print(f"this machine, {threads} threads: {flops:.0f} GFlop/s in single precision, reads {reading:.0f} GB/s")
    A, _ = system.tangent(step)
    solver = Pardiso(threads, single=True, mixed=True)
    solver.factor(A)
    size, ms = 4e-9 * solver.stats["factor_entries"], best(lambda: solver.factor(A))
    print(f"factorisation: {ms:.0f} ms, as much as {1e-3 * flops * ms:.0f} GFlop of products")
    b = np.random.default_rng(0).standard_normal(A.n)
    ms = best(lambda: solver.solve(b))
    print(f"solve: {ms:.1f} ms, the factor's {size:.2f} GB read twice: {2e3 * size / ms:.0f} GB/s")
    ms = best(lambda: system.tangent(step))
    traffic = sum(g.m * g.g * 8 * (9 + 9 + 1 + 1 + 1) for g in system.groups) + 24 * len(A.data)
    print(f"tangent: {ms:.1f} ms, points and matrix {1e-9 * traffic:.2f} GB once: {1e-6 * traffic / ms:.1f} GB/s")
    solver.close()


def main() -> None:
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--models", type=Path, default=DEFAULT)
    ap.add_argument("--only", nargs="*", default=["tissue15_B", "cell_small"])
    ap.add_argument("--threads", type=int, default=2)
    ap.add_argument("--factor", help="name of one model: measure its factorisation instead")
    ap.add_argument("--loops", help="name of one model: time its element loops instead")
    a = ap.parse_args()
    if not a.models.is_dir():
        raise SystemExit(f"{a.models}: no such folder; give --models")
    if a.factor:
        factor_memory(a.models / "models" / f"{a.factor}.feb")
        return
    if a.loops:
        loops(a.models, a.loops, a.threads)
        return
    febio = json.loads((a.models / "febio.json").read_text())
    print("| model | elements | febkit s | FEBio s | ratio | febkit MB | FEBio MB | error of u | error of p |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in a.only:
            s, mb, plot = measured(a.models / "models" / f"{name}.feb", Path(folder), a.threads)
            eu, ep = errors(plot, a.models / "reference" / f"{name}.npz")
            f = febio[name]
            print(
                f"| {name} | {f['elements']} | {s:.1f} | {f['seconds']:.1f} | {f['seconds'] / s:.1f} | {mb:.0f} | "
                f"{f['peak_MB']} | {eu:.1e} | {ep:.1e} |", flush=True,
            )  # fmt: skip


if __name__ == "__main__":
    main()
