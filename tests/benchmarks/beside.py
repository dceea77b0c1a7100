"""febkit beside FEBio: both run the same files in turn on this machine, and a table of ratios is written.

    python tests/benchmarks/beside.py [FILE.feb | FOLDER ...] [--febio FEBIO] [-r 3] [-t 2] [-o table.md]

Without files: the ten everyday models (everyday.py). FEBIO is the command of an FEBio 4 (FEBIO in the environment);
without it febkit alone is measured. Each run is a process of its own, start-up included: seconds of wall time and of
processors, peak memory, iterations as the log counts them; the least of ``-r`` runs each, taken in turn. One run of
febkit goes before them, as the first may compile kernels. u: relative difference of the last state's displacements
(largest over states where both wrote the same ones), in the norm of ``febkit diff``.
"""

from __future__ import annotations

import argparse
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ITERATIONS = re.compile(r"Total number of equilibrium iterations \.+ : (\d+)")


@dataclass
class Run:
    """One program's runs of a model: the least of each figure."""

    seconds: float = math.inf
    processor: float = math.inf
    memory: float = math.inf
    iterations: int = 0
    failed: bool = False


def run(command: list[str], model: Path, out: Path, threads: int, r: Run, limit: float) -> None:
    """Once more; what it wrote is ``out``.xplt and ``out``.log."""
    plot, log = out.with_suffix(".xplt"), out.with_suffix(".log")
    for path in (plot, log):
        path.unlink(missing_ok=True)
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"OMP_NUM_THREADS": str(threads), "MKL_NUM_THREADS": str(threads)}
    start = time.perf_counter()
    process = subprocess.Popen(
        ["timeout", f"{limit:.0f}", *command, "-i", str(model), "-p", str(plot), "-o", str(log), "-silent"],
        env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=out.parent,
    )  # fmt: skip
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    r.seconds = min(r.seconds, time.perf_counter() - start)
    r.processor = min(r.processor, usage.ru_utime + usage.ru_stime)
    r.memory = min(r.memory, usage.ru_maxrss / 1024)
    r.failed |= status != 0
    text = log.read_text(errors="replace") if log.is_file() else ""
    r.iterations = sum(map(int, ITERATIONS.findall(text)))


def difference(a: Path, b: Path) -> float:
    from febkit.results.difference import difference as compare

    for v in compare(a, b, variables=["displacement"]).variables:
        return max((v.relative(s) for s in v.states), default=math.nan)
    return math.nan


def elements(model: Path) -> int:
    import febkit

    return sum(len(b.ids) for b in febkit.read(model).mesh.blocks)


def measure(model: Path, folder: Path, a: argparse.Namespace) -> str:
    """A row of the table."""
    ours, theirs = Run(), Run()
    febkit, febio = [sys.executable, "-m", "febkit", "run", "-t", str(a.threads)], a.febio and [a.febio]
    mine, other = folder / "febkit", folder / "febio"
    run(febkit, model, mine, a.threads, Run(), a.limit)
    for _ in range(a.repeats):
        run(febkit, model, mine, a.threads, ours, a.limit)
        if febio:
            run(febio, model, other, a.threads, theirs, a.limit)
    row = [model.stem, elements(model), _wall(ours)]
    if febio:
        both = not (ours.failed or theirs.failed)
        u = difference(mine.with_suffix(".xplt"), other.with_suffix(".xplt")) if both else math.nan
        row += [_wall(theirs), f"{theirs.seconds / ours.seconds:.1f}", f"{ours.processor:.2f} / {theirs.processor:.2f}",
                f"{ours.memory:.0f} / {theirs.memory:.0f}", f"{ours.iterations} / {theirs.iterations}", f"{u:.0e}"]
    else:
        row += [f"{ours.processor:.2f}", f"{ours.memory:.0f}", ours.iterations]
    return f"| {' | '.join(map(str, row))} |"


def _wall(r: Run) -> str:
    return "failed" if r.failed else f"{r.seconds:.2f}"


def head(febio: bool) -> str:
    names = ["model", "elements", "febkit, s"]
    names += ["FEBio, s", "times faster", "processors, s", "memory, MB", "iterations", "u"] if febio else [
        "processors, s", "memory, MB", "iterations"]  # fmt: skip
    return f"| {' | '.join(names)} |\n|{'---|' * len(names)}"


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("models", nargs="*", type=Path)
    p.add_argument("--febio", default=os.environ.get("FEBIO"))
    p.add_argument("-r", "--repeats", type=int, default=3)
    p.add_argument("-t", "--threads", type=int, default=2)
    p.add_argument("--limit", type=float, default=3600.0, help="seconds after which a run is given up")
    p.add_argument("-o", "--output", type=Path)
    a = p.parse_args()
    if a.febio and not shutil.which(a.febio):
        raise SystemExit(f"{a.febio}: no such command")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        models = [f.resolve() for m in a.models for f in (sorted(m.glob("*.feb")) if m.is_dir() else [m])]
        if not models:
            from everyday import write

            models = write(folder / "models")
        lines = [head(bool(a.febio))]
        print(lines[0], flush=True)
        for model in models:
            lines.append(measure(model, folder, a))
            print(lines[-1], flush=True)
    if a.output:
        a.output.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
