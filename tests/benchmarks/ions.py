"""How many layers of elements the exchange of ions in the middle of a charged tissue needs.

    python tests/benchmarks/ions.py [--layers 11 21 41 81 161]

Away from the cell, case B of the study (pressed evenly, drained on top) is of one dimension: a column of the template's
tissue. Rates of the moles per reference volume in the middle between the stored times, RMS difference to the most
layers over their range.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import febkit
from febkit.solver.run import Listener, Run

TIMES = [0, 1, 2, 5, 10, 12, 15, 20, 30, 50, 100]


class Middle(Listener):
    """Moles of Na+ and volume of water per reference volume in the middle, at the stored times."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.values: list[list[float]] = []

    def save(self, run: Run, status: int) -> None:
        g = run.groups[0]
        at: Any = g.physics.at  # type: ignore[attr-defined]
        z = g.Xg[:, 2].reshape(g.m, g.g).mean(axis=1)
        order = np.argsort(z)
        self.times.append(run.state.time)
        fields = (at.stored()[:, 0], at.J - at.phi0)
        self.values.append([float(np.interp(0.0, z[order], v.reshape(g.m, g.g).mean(axis=1)[order])) for v in fields])


def rates(layers: int, folder: Path) -> Any:
    """Outward rates (interval, 2) of moles and of water."""
    path, middle = folder / f"{layers}.feb", Middle()
    given = ("n=1", f"vertical={layers}", "centre=0.0", f"times={TIMES}")
    made = ["febkit", "new", "tissue", "-o", str(path), "--case", "B", "--physics", "triphasic"]
    subprocess.run([*made, *(x for v in given for x in ("--set", v))], check=True, capture_output=True)
    assert febkit.read(path).solve(threads=1, listeners=[middle]).converged
    return -np.diff(middle.values, axis=0) / np.diff(middle.times)[:, None]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--layers", type=int, nargs="+", default=[11, 21, 41, 81, 161])
    layers = sorted(parser.parse_args().layers)
    with tempfile.TemporaryDirectory() as folder:
        found = {n: rates(n, Path(folder)) for n in layers}
    exact = found[layers[-1]]
    print("| layers | exchange of ions | of water |\n|---|---|---|")
    for n in layers[:-1]:
        off = np.sqrt(((found[n] - exact) ** 2).mean(axis=0)) / np.ptp(exact, axis=0)
        print(f"| {n} | {off[0]:.3f} | {off[1]:.3f} |")


if __name__ == "__main__":
    main()
