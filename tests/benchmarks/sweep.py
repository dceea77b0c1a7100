"""A sweep of Young's modulus: in one process in memory, beside a process for each value, of febkit and of FEBio.

    python tests/benchmarks/sweep.py [--solid] [--values 100] [--elements 500] [--febio PROGRAM] [--processes 100]

The model is the quarter of a biphasic plug in unconfined compression, a ramp of 10 s and a hold to 1000 s in steps of
the time stepper, or with --solid a neo-Hookean block pressed in five steps; its peak force is what the sweep is after.
In memory one febkit.Model is edited and solved again and again; the others write a file for each value, start a
process, and read its plotfile. All of them on one thread, one after the other; kernels are compiled before.
--processes: how many of the values the processes are started for (their mean is what is compared). Prints wall and
processor seconds of each solve, the share of those in memory outside Newton's iterations, and how far the peaks differ.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import febkit
from febkit import materials as mt


def plug(elements: int) -> febkit.Model:
    """About so many biphasic hexahedra."""
    m = febkit.Model("biphasic", units="mm-N-s")
    layers = max(1, round((elements / 3) ** (1 / 3) * 0.9))
    across = 1
    while flat(across) * layers < elements:
        across += 1
    m.add_cylinder("plug", radius=1, height=1, n=(across, layers), sector="quarter")
    m.materials["cartilage"] = mt.Biphasic(
        solid=mt.NeoHookean(E=0.6, v=0.1), permeability=mt.PermConstIso(perm=2e-3), phi0=0.2)  # fmt: skip
    for axis in "xyz":
        m.fix(m.nodes(**{axis: 0}), axis)
    m.fix(m.nodes(where=lambda X: np.hypot(X[:, 0], X[:, 1]) > 0.999), "p")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=-0.05, curve=[(0, 0), (10, 1)])
    m.output.plot = ["displacement", "reaction forces"]
    m.step(time=1000, dt=1, dtmax=100, must_points=[10, 1000], plot="PLOT_MAJOR_ITRS")
    return m


def block(elements: int) -> febkit.Model:
    """About so many solid hexahedra, twice as many along as up."""
    m, n = febkit.Model("solid", units="mm-N-s"), round((elements / 4) ** (1 / 3))
    m.add_block("block", (2, 2, 1), (2 * n, 2 * n, n))
    m.materials["cartilage"] = mt.NeoHookean(E=0.6, v=0.3)
    m.fix(m.nodes(z=0), "x", "y", "z")
    m.node_sets["top"] = m.nodes(z="max")
    m.prescribe("top", z=-0.2, curve=[(0, 0), (1, 1)])
    m.output.plot = ["displacement", "reaction forces"]
    m.step(time=1, dt=0.2)
    return m


def flat(across: int) -> int:
    """Elements in a layer."""
    from febkit.modelling.meshes import cylinder

    return len(cylinder(1.0, 1.0, (across, 1), "quarter")[1])


def peak(ds: object) -> float:
    return -float(ds.febkit.reaction("top").sel(xyz="z").min())  # type: ignore[attr-defined]


def stiffness(m: febkit.Model, E: float) -> None:
    material = m.materials["cartilage"]
    (material.solid if m.module == "biphasic" else material).E = float(E)


newton = [0.0]  # processor seconds


def watched() -> None:
    """Have steps of Newton add up their time."""
    from febkit.solver.newton import Newton

    step = Newton.step

    def timed_step(self: Newton, *args: object) -> object:
        start = time.process_time()
        try:
            return step(self, *args)  # type: ignore[arg-type]
        finally:
            newton[0] += time.process_time() - start

    Newton.step = timed_step  # type: ignore[method-assign,assignment]


def in_memory(m: febkit.Model, values: np.ndarray) -> list[float]:
    peaks = []
    for E in values:
        stiffness(m, E)
        result = m.solve(threads=1)
        assert result.converged, result.reason
        peaks.append(peak(result.dataset))
    return peaks


def processes(m: febkit.Model, values: np.ndarray, command: Callable[[Path], list[str]], folder: Path) -> list[float]:
    peaks = []
    for E in values:
        stiffness(m, E)
        path = folder / "m.feb"
        m.write(path)
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        subprocess.run(command(path), check=True, env=environment, stdout=subprocess.DEVNULL)
        peaks.append(peak(febkit.open_results(path.with_suffix(".xplt")).load()))
    return peaks


def timed(what: str, n: int, run: Callable[[], list[float]]) -> list[float]:
    def used() -> float:
        both = (resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        return sum(u.ru_utime + u.ru_stime for u in both)

    wall, processor = time.perf_counter(), used()
    peaks = run()
    wall, processor = time.perf_counter() - wall, used() - processor
    share = f" {1 - newton[0] / processor:.0%}" if newton[0] else ""
    print(f"| {what} | {n} | {wall / n:.4f} | {processor / n:.4f} |{share} |", flush=True)
    newton[0] = 0.0
    return peaks


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--solid", action="store_true", help="a solid block instead of the plug")
    p.add_argument("--values", type=int, default=100)
    p.add_argument("--elements", type=int, default=500)
    p.add_argument("--processes", type=int, default=100)
    p.add_argument("--febio", help="FEBio's program")
    a = p.parse_args()
    m, values = (block if a.solid else plug)(a.elements), np.linspace(0.3, 0.9, a.values)
    few = values[np.linspace(0, a.values - 1, min(a.processes, a.values)).round().astype(int)]
    in_memory(m, values[:1])  # compiles
    print(f"{sum(len(b.ids) for b in m.mesh.blocks)} elements, {len(m.X)} nodes")
    print("| | solves | wall s each | processor s each | outside Newton |\n|---|---|---|---|---|")
    watched()
    base = dict(zip(values, timed("febkit, in memory", len(values), lambda: in_memory(m, values))))
    with TemporaryDirectory() as name:
        folder = Path(name)
        commands: dict[str, Callable[[Path], list[str]]] = {
            "febkit, a process each": lambda f: [sys.executable, "-m", "febkit", "run", str(f), "-silent", "-t", "1"]
        }
        if a.febio:
            commands["FEBio 4.11, a process each"] = lambda f: [
                a.febio, "-i", str(f), "-o", str(f.with_suffix(".log")), "-p", str(f.with_suffix(".xplt")), "-silent"]
        for what, command in commands.items():
            peaks = timed(what, len(few), lambda command=command: processes(m, few, command, folder))  # type: ignore[misc]
            worst = max(abs(q / base[E] - 1) for E, q in zip(few, peaks))
            print(f"  peaks differ from those in memory by {worst:.1e} at most")


if __name__ == "__main__":
    main()
