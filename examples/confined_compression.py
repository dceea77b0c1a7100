"""The solver as a library, no input file: a confined column squeezed slowly, then held.

``python examples/confined_compression.py`` prints by how much the stress differs from the series of
Mow, Kuei, Lai and Armstrong (J Biomech Eng 102, 1980); :func:`main` returns it. Units: mm, N, s.
"""

from __future__ import annotations

import numpy as np

from febkit.solver.fields import DISPLACEMENT, PRESSURE, Layout
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import TRANSIENT, Block, Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.run import Listener, Run, run
from febkit.solver.solids.isotropic_elastic import IsotropicElastic
from febkit.solver.values import Constant, Scaled

LAYOUT = Layout([DISPLACEMENT, PRESSURE])
X, Y, Z = LAYOUT.displacement.tolist()  # columns of the unknowns
P = LAYOUT.column("p")
E, V, K = 0.6, 0.2, 0.5  # MPa, -, mm^4/(N s)
RATE, HOLD = -1e-4, 1.0  # mm/s until 1 s; the column is 1 mm high


def column(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and n hexahedra of a column, thinner towards the drained top."""
    z = 1.0 - (1.0 - np.linspace(0.0, 1.0, n + 1)) ** 1.6
    square = [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1), (0.0, 0.1)]
    nodes = np.array([(x, y, h) for h in z for x, y in square])
    k = 4 * np.arange(n)[:, None]
    return nodes, np.hstack([k + np.arange(4), k + 4 + np.arange(4)])


def problem(n: int, dt: float) -> Problem:
    """Sides fixed, bottom fixed and tight, top drained and moved."""
    nodes, conn = column(n)
    bottom, top = np.arange(4), np.arange(4 * n, 4 * n + 4)
    move = Scaled(Constant(RATE * HOLD), lambda t: min(t / HOLD, 1.0))
    step = Step(analysis=TRANSIENT, dt=dt, count=round(2.0 / dt), newton=NewtonOptions(symmetric=True))
    step.conditions = [Fixed(X, np.arange(len(nodes))), Fixed(Y, np.arange(len(nodes))), Fixed(Z, bottom),
                       Prescribed(Z, top, move), Fixed(P, top)]  # fmt: skip
    physics = Biphasic(ConstIso(K), Constant(0.2))
    block = Block("column", "hex8", conn, np.arange(1, n + 1), IsotropicElastic(E, V), physics)
    return Problem(nodes, [block], [step])


def series(t: np.ndarray) -> np.ndarray:
    """Stress at the top (MPa) of Mow's theory."""
    H, m = E * (1 - V) / ((1 + V) * (1 - 2 * V)), np.arange(1, 200)

    def decay(s: np.ndarray) -> np.ndarray:
        return np.asarray((np.exp(-np.outer(np.maximum(s, 0.0), m**2) * np.pi**2 * H * K) / m**2).sum(1) * 2 / np.pi**2)

    during = H * RATE * t + RATE / K * (1 / 3 - decay(t))
    return np.where(t <= HOLD, during, H * RATE * HOLD + RATE / K * (decay(t - HOLD) - decay(t)))


class Stress(Listener):
    """Writes down the mean stress on top after every step."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.stress: list[float] = []

    def converged(self, run: Run, counts: object) -> None:
        self.times.append(run.state.time)
        self.stress.append(run.state.reaction[-4:, Z].sum() / 0.01)


def main(n: int = 20, dt: float = 0.025) -> float:
    """Largest difference from the series at 1 s and 2 s, relative to the largest stress."""
    top = Stress()
    result = run(problem(n, dt), [top])
    assert result.converged, result.reason
    t, s = np.array(top.times), np.array(top.stress)
    at = [int(np.argmin(abs(t - when))) for when in (1.0, 2.0)]
    return float((np.abs(s - series(t))[at] / np.abs(series(t)).max()).max())


if __name__ == "__main__":
    print(f"difference from the series: {100 * main():.2f} %")
