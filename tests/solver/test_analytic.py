"""Biphasic problems of small strain with known series: confined compression, consolidation, Cryer's sphere."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from febkit.solver.loads.base import patches
from febkit.solver.loads.pressure import Pressure
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import TRANSIENT, Fixed, Problem, Step
from febkit.solver.run import Listener, Run, run
from febkit.solver.solids.isotropic_elastic import IsotropicElastic
from helpers import scenes
from helpers.scenes import P

E, V, K = 0.6, 0.2, 0.5
HA = E * (1 - V) / ((1 + V) * (1 - 2 * V))  # aggregate modulus
M = np.arange(1, 400)


class History(Listener):
    """Keeps what ``look(run)`` gives after every step."""

    def __init__(self, look: Any) -> None:
        self.look, self.t, self.values = look, [], []

    def converged(self, run: Run, counts: Any) -> None:
        self.t.append(run.state.time)
        self.values.append(self.look(run))


def _solve(p: Problem, look: Any) -> tuple[Any, Any]:
    h = History(look)
    result = run(p, [h], Options(threads=1))
    assert result.converged, result.reason
    return np.array(h.t), np.array(h.values)


def relaxation(t: Any, rate: float, t0: float) -> Any:
    """Stress under a ramp of the surface (rate < 0), then rest; unit height (Mow et al., J Biomech Eng 102, 1980)."""

    def series(s: Any) -> Any:
        return (np.exp(-np.outer(np.maximum(s, 0.0), M**2) * np.pi**2 * HA * K) / M**2).sum(1) * 2 / np.pi**2

    during = HA * rate * t + rate / K * (1 / 3 - series(t))
    after = HA * rate * t0 + rate / K * (series(t - t0) - series(t))
    return np.where(t <= t0, during, after)


def _relaxation_error(n: int, steps: int) -> float:
    top = -1e-6
    p = scenes.column(n, E, V, K, top=top, grading=1.6)
    p.steps[0].dt, p.steps[0].count = 2.0 / steps, steps
    nodes = np.flatnonzero(p.X[:, 2] > 1 - 1e-9)
    t, force = _solve(p, lambda r: r.state.reaction[nodes, 2].sum())
    expected = relaxation(t, top, 1.0)
    settled = (t > 0.2) & ~((t > 1.0) & (t < 1.2))  # the stress goes with sqrt(t) at first: order 1/2 there
    return float(np.abs(force / 0.01 - expected)[settled].max() / np.abs(expected).max())


def test_stress_relaxation_in_confined_compression() -> None:
    """Backward Euler decides the error: half the step, half the error; 1 % at 80 steps."""
    coarse, fine = _relaxation_error(10, 40), _relaxation_error(20, 80)
    assert fine < 0.6 * coarse
    assert fine < 0.01


def _terzaghi(n: int, steps: int) -> float:
    """Largest pressure error, relative to the load, of a column loaded at once, at T = 0.02 ... 0.2."""
    load = 1e-6
    p = scenes.column(n, E, V, K, grading=1.4)
    s = p.steps[0]
    s.loads = [Pressure(patches({"quad4": scenes.top_quads(n)}, p.X), pressure=load, linear=True)]
    T = 0.2 / (HA * K)
    s.dt, s.count = T / steps, steps
    line = np.flatnonzero((p.X[:, 0] < 1e-9) & (p.X[:, 1] < 1e-9))
    t, pressure = _solve(p, lambda r: r.state.p[line] / load)
    odd = 2 * M - 1
    phase = np.sin(np.outer(1 - p.X[line, 2], odd) * np.pi / 2) * 4 / (np.pi * odd)
    exact = np.exp(-np.outer(t, odd**2) * np.pi**2 / 4 * HA * K) @ phase.T
    late = t > 0.1 * T
    return float(np.abs(pressure - exact)[late].max())


def test_terzaghi_consolidation() -> None:
    coarse, fine = _terzaghi(10, 40), _terzaghi(20, 80)
    assert fine < 0.65 * coarse
    assert fine < 0.015


# ---- Cryer's sphere ---------------------------------------------------------------------------------
def octant(n: int, layers: int) -> tuple[Any, Any, Any]:
    """Nodes, hexahedra and outer quads of an octant of the unit ball: a cube in three shells."""
    s = np.linspace(0.0, 1.0, n + 1)
    core = 0.45 * np.stack(np.meshgrid(s, s, s, indexing="ij"), axis=-1)
    core *= 1 - 0.06 * (core**2).sum(-1, keepdims=True) / 0.45**2
    blocks, r = [core], np.linspace(0.0, 1.0, layers + 1)[:, None, None, None]
    for axis in range(3):
        face = np.take(core, n, axis=axis)
        tangent = np.stack(np.meshgrid(s, s, indexing="ij"), axis=-1)
        tangent = np.tan(np.pi / 4 * tangent)
        outer = np.insert(tangent, axis, 1.0, axis=-1)
        outer /= np.linalg.norm(outer, axis=-1, keepdims=True)
        blocks.append(face * (1 - r) + outer * r)
    X, quads, start, conn = [], [], 0, []
    for b, x in enumerate(blocks):
        k = np.arange(x[..., 0].size).reshape(x.shape[:3]) + start
        start += k.size
        cut = [slice(0, -1), slice(1, None)]
        corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
        cells = np.stack([k[cut[i], cut[j], cut[m]] for i, j, m in corners], axis=-1).reshape(-1, 8)
        turned = b == 2  # radial, x, z is a left-handed frame
        conn.append(cells[:, [0, 3, 2, 1, 4, 7, 6, 5]] if turned else cells)
        if b:
            last = k[-1]
            q = np.stack([last[:-1, :-1], last[1:, :-1], last[1:, 1:], last[:-1, 1:]], axis=-1).reshape(-1, 4)
            quads.append(q[:, ::-1] if turned else q)
        X.append(x.reshape(-1, 3))
    x = np.vstack(X)
    _, first, same = np.unique(np.round(x, 9), axis=0, return_index=True, return_inverse=True)
    same = same.reshape(-1)
    return x[first], same[np.vstack(conn)], same[np.vstack(quads)]


def cryer(T: Any, v: float) -> Any:
    """Pressure at the centre over the load at T = c t / a^2 (Cryer 1963; Verruijt, Theory and Problems of
    Poroelasticity, section on Cryer's problem), incompressible constituents."""
    eta = (1 - v) / (1 - 2 * v)

    def f(x: float) -> float:
        return float((1 - eta * x * x / 2) * np.sin(x) - x * np.cos(x))

    roots = [brentq(f, j * np.pi + 1e-9, (j + 1) * np.pi - 1e-9) for j in range(1, 200) if
             f(j * np.pi + 1e-9) * f((j + 1) * np.pi - 1e-9) < 0]
    low = np.linspace(1e-3, np.pi, 4000)
    values = [f(x) for x in low]
    roots += [brentq(f, a, b) for a, b, fa, fb in zip(low, low[1:], values, values[1:]) if fa * fb < 0]
    x = np.array(sorted(roots))
    weight = eta * (np.sin(x) - x) / ((eta - 1) * np.sin(x) + eta * x * np.cos(x) / 2)
    return np.exp(-np.outer(T, x * x)) @ weight


def _sphere(n: int, layers: int, dt: float, v: float = 0.0) -> tuple[Any, Any]:
    X, conn, quads = octant(n, layers)
    load = 1e-6
    outer = np.unique(quads)
    conditions: list[Any] = [Fixed(c, np.flatnonzero(X[:, c] < 1e-9)) for c in range(3)] + [Fixed(P, outer)]
    newton = scenes.tight(dtol=1e-7, ptol=1e-7, min_residual=1e-30)
    step = Step(analysis=TRANSIENT, dt=dt, count=round(0.25 / dt), newton=newton, conditions=conditions)
    step.loads = [Pressure(patches({"quad4": quads}, X), pressure=load, linear=True)]
    c = 1.0 * (1 - v) / ((1 + v) * (1 - 2 * v))
    block = scenes.block("hex8", conn, IsotropicElastic(1.0, v), Biphasic(ConstIso(1.0 / c)))
    center = int(np.argmin((X**2).sum(1)))
    return _solve(Problem(X, [block], [step]), lambda r: r.state.p[center] / load)


def test_the_series_starts_at_the_load() -> None:
    assert cryer(np.array([3e-4]), 0.0)[0] == pytest.approx(1.0, abs=0.05)


def test_cryer_sphere_shows_the_mandel_cryer_rise() -> None:
    """The pressure at the centre rises above the load before it falls; refined, it meets the series."""
    errors = []
    for n, layers, dt in ((2, 4, 0.01), (3, 8, 0.005)):
        t, p = _sphere(n, layers, dt)
        exact = cryer(t, 0.0)
        errors.append(np.abs(p - exact)[t > 0.02].max())
        assert p.max() > 1.3  # 1.5 at v = 0
        assert p[-1] < 1.0
    assert errors[1] < 0.65 * errors[0]
    assert errors[1] < 0.04
