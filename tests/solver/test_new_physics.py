"""To add a physics takes one file: heat conduction, all of it here, solved to its analytic answers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
import pytest

from febkit.solver.fields import DISPLACEMENT, Field, Layout
from febkit.solver.options import Options
from febkit.solver.physics.base import Physics, Work
from febkit.solver.problem import (
    STEADY,
    TRANSIENT,
    Block,
    Fixed,
    Initial,
    NewtonOptions,
    Prescribed,
    Problem,
    Step,
)
from febkit.solver.result import Result
from febkit.solver.run import Listener, Run, run
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.values import Constant, Expression
from helpers import scenes

TEMPERATURE = Field("temperature", ("T",), "ttol", 1e-9)


class HeatWork(Work):
    """T (m, g) now and at the last converged state; G (m, g, n, 3) gradients of the shape functions."""

    memory: ClassVar[tuple[str, ...]] = ("T", "old")

    def __init__(self, group: Any, physics: Heat) -> None:
        super().__init__(group, physics)
        self.law = physics
        self.T, self.old = np.zeros((group.m, group.g)), np.zeros((group.m, group.g))
        self.G = np.einsum("gak,egki->egai", group.dN, group.iJ0)
        X = group.Xg.reshape(group.m, group.g, 3)
        self.source = physics.source(X[..., 0])

    def start(self, state: Any) -> None:
        for c in self.group.chunks:
            self.update(c, state, [])

    def update(self, c: Any, state: Any, drive: list[Any]) -> None:
        T = state.of("temperature")[self.group.conn[c.lo : c.hi], 0]
        self.T[c.lo : c.hi] = T @ self.group.N.T

    def residual(self, lo: int, hi: int, state: Any, R: Any, steady: bool) -> None:
        g, e = self.group, slice(lo, hi)
        T = state.of("temperature")[g.conn[e], 0]
        grad = np.einsum("egai,ea->egi", self.G[e], T)
        rate = 0.0 if steady else (self.T[e] - self.old[e]) / state.dt
        f = self.law.k * np.einsum("eg,egai,egi->ea", g.wJ0[e], self.G[e], grad)
        f += np.einsum("eg,ga->ea", g.wJ0[e] * (rate - self.source[e]), g.N)
        np.add.at(state.layout.scalar(R, "temperature"), g.conn[e], -f)

    def tangent(self, c: Any, state: Any, target: Any, work: Any, steady: bool) -> None:
        g, e = self.group, slice(c.lo, c.hi)
        K = self.law.k * np.einsum("eg,egai,egbi->eab", g.wJ0[e], self.G[e], self.G[e])
        if not steady:
            K += np.einsum("eg,ga,gb->eab", g.wJ0[e] / state.dt, g.N, g.N)
        target.add(g, c.lo, c.hi, np.ascontiguousarray(K))

    def begin_step(self, state: Any) -> None:
        self.old[...] = self.T

    def rates(self) -> list[tuple[Any, Any]]:
        return [(self.old, self.T)]


@dataclass(eq=False)
class Heat(Physics):
    """dT/dt - k laplace T = source(x)."""

    k: float = 1.0
    source: Any = field(default=np.zeros_like)
    name: ClassVar[str] = "heat"
    rates: ClassVar[bool] = True
    work: ClassVar[type[Work]] = HeatWork

    @property
    def fields(self) -> tuple[Field, ...]:
        return (TEMPERATURE,)


class Keep(Listener):
    """The groups of a run, to look at their points."""

    def end(self, run: Run, result: Result) -> None:
        self.groups = run.groups


def slab(n: int, heat: Heat, step: Step, kind: str = "hex8") -> tuple[Result, float]:
    """Solve a slab 0 < x < 1 of n elements, cold at both ends; the result and the error in L2 against ``exact``."""
    X, conn = scenes.grid((n, 1, 1), (1.0, 1.0 / n, 1.0 / n))
    ends = np.flatnonzero((X[:, 0] < 1e-9) | (X[:, 0] > 1 - 1e-9))
    step.conditions = [Fixed(0, ends)]
    step.initial = [Initial(0, np.arange(len(X)), Expression(lambda X, Y, Z, t: np.sin(np.pi * X)))]
    step.newton = NewtonOptions(etol=0.0, min_residual=1e-40)
    keep = Keep()
    accuracy = 0.0 if step.auto is None else 1e-6
    result = run(Problem(X, [Block("slab", kind, conn, np.arange(len(conn)), physics=heat)], [step]), [keep],
                 Options(threads=1, accuracy=accuracy))  # fmt: skip
    assert result.converged, result.reason
    g = keep.groups[0]
    decay = 1.0 if step.analysis == STEADY else np.exp(-heat.k * np.pi**2 * result.state.time)
    exact = decay * np.sin(np.pi * g.Xg[:, 0]).reshape(g.m, g.g)
    return result, float(np.sqrt((g.wJ0 * (g.physics.T - exact) ** 2).sum() / g.wJ0.sum()))


def rate(errors: list[float]) -> float:
    """Order of convergence over the last halving."""
    return float(np.log2(errors[-2] / errors[-1]))


def test_a_steady_slab_with_a_source() -> None:
    heat = Heat(2.0, lambda x: 2.0 * np.pi**2 * np.sin(np.pi * x))
    errors = [slab(n, heat, Step(analysis=STEADY, dt=1.0, count=1))[1] for n in (4, 8, 16)]
    assert rate(errors) == pytest.approx(2.0, abs=0.05) and errors[-1] < 5e-3


def test_a_slab_that_cools_down() -> None:
    """First order in time; second in space, with steps that follow (dt as h^2)."""
    errors = [slab(64, Heat(1.0), Step(analysis=TRANSIENT, dt=0.1 / n, count=n))[1] for n in (4, 8, 16)]
    assert rate(errors) == pytest.approx(1.0, abs=0.1)
    errors = [slab(n, Heat(1.0), Step(analysis=TRANSIENT, dt=1.6 * 0.1 / n**2, count=n**2 // 2))[1] for n in (4, 8, 16)]
    assert rate(errors) == pytest.approx(2.0, abs=0.15)


def test_it_gets_steps_of_second_order() -> None:
    """From saying which arrays its rates are differences of."""
    from febkit.solver.problem import AutoStep

    coarse, error = slab(64, Heat(1.0), Step(analysis=TRANSIENT, dt=1e-3, count=100, auto=AutoStep(must_points=(0.1,))))
    first, plain = slab(64, Heat(1.0), Step(analysis=TRANSIENT, dt=1e-3, count=100))
    assert coarse.totals.steps < first.totals.steps and error < 0.1 * plain


@pytest.mark.parametrize("order", [(DISPLACEMENT, TEMPERATURE), (TEMPERATURE, DISPLACEMENT)])
def test_it_lives_beside_a_solid(order: tuple[Field, ...]) -> None:
    """Two blocks share nodes, one solved for displacements and one for temperatures: each as if alone."""
    X, conn = scenes.grid((2, 2, 4))
    low, high = conn[X[conn][:, :, 2].max(axis=1) < 0.6], conn[X[conn][:, :, 2].min(axis=1) > 0.4]
    layout = Layout(order)
    bottom, middle, top = (np.flatnonzero(np.abs(X[:, 2] - z) < 1e-9) for z in (0.0, 0.5, 1.0))
    u = [layout.column(c) for c in "xyz"]
    step = Step(analysis=STEADY, dt=1.0, count=1, newton=scenes.tight(), conditions=[
        *(Fixed(c, bottom) for c in u), Prescribed(u[2], middle, Constant(-0.05)),
        Prescribed(layout.column("T"), middle, Constant(1.0)), Prescribed(layout.column("T"), top, Constant(3.0)),
    ])  # fmt: skip
    solid = Block("low", "hex8", low, np.arange(len(low)), NeoHookean(1.0, 0.3))
    heat = Block("high", "hex8", high, np.arange(len(high)), physics=Heat(5.0))
    both = run(Problem(X, [solid, heat], [step], fields=layout))
    assert both.converged, both.reason
    T = both.state.of("temperature")[:, 0]
    np.testing.assert_allclose(T[X[:, 2] > 0.4], 1.0 + 4.0 * (X[X[:, 2] > 0.4, 2] - 0.5), atol=1e-12)
    step.conditions = [c for c in step.conditions if c.column in u]
    alone = run(Problem(X, [solid], [step], fields=layout))
    np.testing.assert_allclose(both.state.u, alone.state.u, atol=1e-12)
    assert np.abs(alone.state.u[:, :2]).max() > 1e-3


def test_no_element_type_is_special() -> None:
    """Any solid element takes it: an affine temperature is reproduced."""
    for kind in ("tet4", "hex8", "tet10", "hex20"):
        X, conn = scenes.box(kind, (2, 2, 2), 0.2)
        skin = scenes.skin(X)
        T = 1.0 + X @ np.array([0.5, -1.0, 2.0])
        step = Step(analysis=STEADY, dt=1.0, count=1, newton=scenes.tight())
        step.conditions = scenes.prescribe(skin, T[skin, None], 0)
        result = run(Problem(X, [Block("part", kind, conn, np.arange(len(conn)), physics=Heat())], [step]))
        np.testing.assert_allclose(result.state.of("temperature")[:, 0], T, atol=1e-12)
