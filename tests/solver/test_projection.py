"""Pressure projection: no oscillation below the Vermeer-Verruijt step, and the order of the elements kept."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver.kernels import projection
from febkit.solver.loads.base import patches
from febkit.solver.loads.pressure import Pressure
from febkit.solver.options import Options
from febkit.solver.run import run
from helpers import charged, scenes

E, V, K = 0.6, 0.2, 0.5
HA = E * (1 - V) / ((1 + V) * (1 - 2 * V))


def _consolidated(n: int, dt: float, steps: int, tau: float) -> tuple[Any, Any]:
    """Heights and pressures over the load of a column that is loaded at once, after ``steps``."""
    load = 1e-6
    p = scenes.column(n, E, V, K)
    step = p.steps[0]
    step.loads = [Pressure(patches({"quad4": scenes.top_quads(n)}, p.X), pressure=load, linear=True)]
    step.dt, step.count = dt, steps
    result = run(p, options=Options(threads=1, stabilise=tau))
    assert result.converged, result.reason
    line = np.flatnonzero((p.X[:, 0] < 1e-9) & (p.X[:, 1] < 1e-9))
    return p.X[line, 2], result.state.p[line] / load


def _exact(z: Any, t: float) -> Any:
    odd = 2 * np.arange(1, 400) - 1
    phase = np.sin(np.outer(1 - z, odd) * np.pi / 2) * 4 / (np.pi * odd)
    return phase @ np.exp(-(odd**2) * np.pi**2 / 4 * HA * K * t)


def test_no_oscillation_below_the_vermeer_verruijt_step() -> None:
    """The step is a hundredth of h^2 / (6 c): the pressure must lie between 0 and the load."""
    n = 10
    dt = 0.01 * (1 / n) ** 2 / (6 * HA * K)
    plain, steady = (_consolidated(n, dt, 1, tau)[1] for tau in (0.0, 1.0))
    assert plain.max() > 1.1
    assert steady.max() < 1.02 and steady.min() > -1e-9


@pytest.mark.parametrize("tau", [0.0, 1.0])
def test_order_in_space_is_kept(tau: float) -> None:
    error, t, steps = [], 0.2 / (HA * K), 400
    fine = _consolidated(80, t / steps, steps, 0.0)
    for n in (5, 10, 20):
        z, p = _consolidated(n, t / steps, steps, tau)
        error.append(np.sqrt(np.mean((p - np.interp(z, *fine)) ** 2)))
    rates = np.log2(np.array(error[:-1]) / error[1:])
    assert (rates > 1.8).all(), (error, rates)
    assert np.abs(p - _exact(z, t)).max() < 5e-3


def test_tangent_of_the_projection() -> None:
    """Derivative of the force by the nodal pressures; a constant change of pressure meets no force."""
    rng = np.random.default_rng(5)
    N, w0, c = rng.random((8, 8)), rng.random((1, 8)) + 0.1, np.array([0.7])
    N /= N.sum(axis=1, keepdims=True)
    conn, p = np.arange(8, dtype=np.int32)[None], rng.normal(size=8)

    def force(p: Any) -> Any:
        R = np.zeros((8, 4))
        projection.force(0, 1, conn, N, w0, c, (N @ p)[None], np.zeros((1, 8)), R)
        return R[:, 3]

    M = np.zeros((1, 32, 32))
    projection.tangent(0, 1, N, w0, c, M, 24, 24)
    np.testing.assert_allclose(-M[0, 24:, 24:] @ p, force(p), rtol=1e-12)
    np.testing.assert_allclose(force(np.full(8, 3.0)), 0.0, atol=1e-14)


# ---- mixtures with solutes --------------------------------------------------------------------------


def _charged(n: int, dt: float, steps: int, tau: float) -> tuple[Any, Any]:
    """Heights and changes of p~ over the load of a charged tissue at rest in its bath that is loaded at once."""
    L, load, bath = 0.5, 1e-4, {"Na+": 150.0, "Cl-": 150.0}
    m = charged.block((L / n, L / n, L), (1, 1, n), [charged.solute(i, hindered=0.6) for i in bath],
                      fixed_charge_density=-120.0)  # fmt: skip
    m.materials["tissue"]["fixed_charge_density"].curve = m.curves.add([(0, 0), (1000, 1)])
    m.fix("all", "x", "y")
    m.fix(m.nodes(z="min"), "z")
    charged.start(m, bath)
    charged.bathe(m, m.nodes(z="max"), bath)
    m.step(time=20000.0, dt=2000.0, fixed=True, solver=charged.TIGHT)
    m.step(time=dt * steps, dt=dt, fixed=True, solver=charged.TIGHT)
    m.steps[1].load(m.faces(z="max"), "traction", traction=(0, 0, -load))
    result = charged.solved(m, stabilise=tau)
    line = np.argsort(m.X[:, 2], kind="stable")[::4]
    return m.X[line, 2], (result.state.p[line] + 2 * charged.RT * 150.0) / load


def test_no_oscillation_in_a_charged_tissue() -> None:
    n, aggregate = 10, charged.LAM + 2 * charged.MU
    dt = 0.01 * (0.5 / n) ** 2 / (6 * aggregate * charged.PERM)
    plain, steady = (_charged(n, dt, 1, tau)[1] for tau in (0.0, 1.0))
    assert plain.max() > 1.5
    assert steady.max() < 1.02 and steady.min() > -1e-6


def test_order_in_space_is_kept_in_a_charged_tissue() -> None:
    fine = _charged(32, 20.0, 8, 0.0)
    error = []
    for n in (4, 8):
        z, p = _charged(n, 20.0, 8, 1.0)
        error.append(np.sqrt(np.mean((p - np.interp(z, *fine)) ** 2)))
    assert fine[1].max() > 0.5 and np.log2(error[0] / error[1]) > 1.8, (fine[1].max(), error)
