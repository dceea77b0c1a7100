"""Processor seconds of a folder of small models, start-up included, beside FEBio's recorded seconds.

    python tests/benchmarks/small.py FOLDER [--only REGEX] [--threads 0] [--warm] [--worst 15] [--table FILE]

FOLDER holds ``models/*.feb`` and, in ``reference/``, ``index.json`` (FEBio's seconds) and ``<model>.npz`` (its u and
p). Each model is a process of its own, ``febkit run MODEL -silent``: user and system time of all its threads, as the
kernel counts them, from the start of the interpreter to its end. A model is run twice and the second run counted,
since the first may compile kernels (--warm: they are on disk already, run once). Only models that agree with FEBio
are added up: displacement and pressure within 1e-4 (relative, L2, at every stored state).

Python's bytecode is kept over the runs, as it is where febkit was installed by pip: compiling febkit's sources in
every process would add 0.1 s to each.

What the sum does not say: FEBio's seconds were taken once, on one thread, on another and noisy machine, without its
own start-up being left out or put in on purpose; they are good for sums and large ratios. Ours vary by some 10 %
with what else the machine does. Models that febkit refuses, or answers otherwise, are in neither sum. Prints models
by excess over FEBio, worst first, then a Markdown line.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

AGREES = 1e-4


@dataclass
class Measured:
    """One model: its processor seconds, FEBio's seconds, and the larger relative error of u and p."""

    model: str
    seconds: float
    febio: float
    error: float

    @property
    def excess(self) -> float:
        return self.seconds - self.febio


def processor_seconds(model: Path, out: Path, threads: int, limit: float) -> float | None:
    """Of one `febkit run` in a process of its own; None where it does not end well."""
    plot, log = out / f"{model.stem}.xplt", out / f"{model.stem}.log"
    command = [sys.executable, "-m", "febkit.cli.main", "run", str(model), "-p", str(plot), "-o", str(log), "-silent"]
    soft = f"ulimit -t {limit:.0f}; exec \"$@\""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = str(out / "bytecode")
    process = subprocess.Popen(
        ["sh", "-c", soft, "sh", *command, "-t", str(threads)], stderr=subprocess.DEVNULL, env=environment
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_utime + usage.ru_stime if status == 0 else None


def error(plot: Path, reference: Path) -> float:
    """Largest relative L2 error of u and p over the states of the reference; infinite where states are missing."""
    import febkit

    ref, ds = np.load(reference), febkit.open_results(plot)
    times = ds["time"].values
    near = [int(np.argmin(np.abs(times - t))) for t in ref["times"]]
    if np.any(np.abs(times[near] - ref["times"]) > 1e-5 * max(abs(float(ref["times"][-1])), 1e-30)):
        return np.inf
    worst, size = 0.0, np.ptp(ds["node_position"].values, axis=0).max() if "node_position" in ds else 1.0
    for name, key, floor in (("displacement", "u", 1e-9 * size), ("effective_fluid_pressure", "p", 0.0)):
        if key not in ref or not np.nanmax(np.abs(ref[key]), initial=0.0):
            continue
        if name not in ds:
            return np.inf
        values = ds[name].values
        floor = floor or 1e-3 * np.nanmax(np.abs(ref[key]))
        floor *= np.sqrt(len(ref["node_id"]))
        for k, want in zip(near, ref[key]):
            has = np.isfinite(want)
            gap = np.linalg.norm((values[k] - want)[has])
            worst = max(worst, gap / max(np.linalg.norm(want[has]), floor))
    return float(worst)


def measure(folder: Path, only: str, threads: int, warm: bool, limit: float) -> list[Measured]:
    """All models of a folder whose names match, small files first."""
    index, done = json.loads((folder / "reference" / "index.json").read_text()), []
    with tempfile.TemporaryDirectory() as name:
        out = Path(name)
        for model in sorted((folder / "models").glob("*.feb"), key=lambda p: p.stat().st_size):
            reference = folder / "reference" / f"{model.stem}.npz"
            if not re.search(only, model.stem) or not reference.exists():
                continue
            seconds = processor_seconds(model, out, threads, limit)
            if seconds is not None and not warm:
                seconds = processor_seconds(model, out, threads, limit)
            if seconds is not None:
                plot = out / f"{model.stem}.xplt"
                done.append(Measured(model.stem, seconds, index[model.stem]["seconds"], error(plot, reference)))
                plot.unlink()
                print(f"{done[-1]}", file=sys.stderr, flush=True)
    return done


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("folder", type=Path)
    p.add_argument("--only", default=".")
    p.add_argument("--threads", type=int, default=0)
    p.add_argument("--warm", action="store_true")
    p.add_argument("--worst", type=int, default=15)
    p.add_argument("--limit", type=float, default=600.0, help="processor seconds after which a model is given up")
    p.add_argument("--table", type=Path, help="write all figures there as JSON")
    a = p.parse_args()
    done = measure(a.folder, a.only, a.threads, a.warm, a.limit)
    if a.table:
        a.table.write_text(json.dumps([asdict(m) for m in done], indent=1))
    agree = [m for m in done if m.error < AGREES]
    for m in sorted(agree, key=lambda m: -m.excess)[: a.worst]:
        print(f"{m.model:12s} {m.seconds:7.2f} s, FEBio {m.febio:7.2f} s, more by {m.excess:6.2f} s")
    for m in done:
        if m.error >= AGREES:
            print(f"{m.model:12s} is left out: it differs from FEBio by {m.error:.1e}")
    ours, theirs = sum(m.seconds for m in agree), sum(m.febio for m in agree)
    slower = sum(m.excess > 0 for m in agree)
    print(f"| {a.folder.name}, {len(agree)} models, processor seconds with start-up | {ours:.1f} s (FEBio {theirs:.1f} s; {slower} models slower than FEBio) |")  # noqa: E501


if __name__ == "__main__":
    main()
