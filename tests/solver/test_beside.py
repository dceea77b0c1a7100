"""Residuals of variations had beside the run's, against those of the variations' own elements."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import loads, permeabilities
from febkit.solver.alike import alike
from febkit.solver.beside import Beside
from febkit.solver.controllers import LoadCurve
from febkit.solver.options import Options
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import DYNAMIC, TRANSIENT, Fixed, Prescribed, Problem, Step
from febkit.solver.run import Listener, Run
from febkit.solver.sensitivity import STEP, Sensitivities
from febkit.solver.solids.mooney_rivlin import MooneyRivlin
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.solids.viscoelastic import Viscoelastic
from febkit.solver.values import Constant, Map, Scaled
from helpers import scenes

GIVEN = {"E": 1.0, "perm": 0.5, "c1": 0.4, "top": -0.08, "push": 0.02, "rise": 1.0}


def scene(kind: str, analysis: str = TRANSIENT, viscous: bool = False, **amounts: float) -> Problem:
    """Elements of which one part is porous and one is not, pressed down, pushed aside, and let go in a second step."""
    p = GIVEN | amounts
    X, conn = scenes.box(kind, (1, 1, 2))
    low = X[conn].mean(axis=1)[:, 2] < 0.5
    solid: Any = NeoHookean(p["E"], 0.2)
    if viscous:
        solid = Viscoelastic(solid, g1=0.5, t1=0.6)
    flow = permeabilities.load("perm-Holmes-Mow")(perm=p["perm"], M=1.5, alpha=2.0)
    blocks = [
        scenes.block(kind, conn[low], solid, Biphasic(flow, phi0=Constant(0.2))),
        scenes.block(kind, conn[~low], MooneyRivlin(p["c1"], 0.1, k=8.0)),
    ]
    blocks[1].name = "top"
    floor, top, side = np.flatnonzero(X[:, 2] == 0.0), np.flatnonzero(X[:, 2] == 1.0), np.flatnonzero(X[:, 0] == 1.0)
    curve = LoadCurve([(0.0, 0.0), (p["rise"], 1.0)])
    held: list[Any] = [*(Fixed(c, floor) for c in range(3)), Fixed(scenes.P, side)]
    press = Prescribed(scenes.UZ, top, Scaled(Constant(p["top"]), curve))
    push = loads.load("nodal_load")(side, X[side], dof="x", scale=Scaled(Constant(p["push"]), curve))
    rest: dict[str, Any] = {"dt": 0.5, "count": 2, "analysis": analysis, "newton": scenes.tight(dtol=1e-10, ptol=1e-10)}
    own = [push] if analysis == DYNAMIC or viscous else []
    steps = [Step(conditions=[*held, press], loads=own, **rest), Step(conditions=held, **rest)]
    return Problem(X, blocks, steps)


class Kept(Listener):
    """Derivatives of nodal values and reactions by all parameters, at each state that is saved."""

    def __init__(self, of: Sensitivities, nodal: bool) -> None:
        self.of, self.nodal, self.values = of, nodal, [np.zeros(0)]

    def save(self, run: Run, status: int) -> None:
        for k in range(len(self.of.runs)):
            high, low, delta = self.of.ends(k, self.nodal)
            self.values += [(getattr(high.state, n) - getattr(low.state, n)) / delta for n in ("d", "reaction")]


def derivatives(kind: str, nodal: bool = False, threads: int = 1, **of: Any) -> tuple[list[Any], Sensitivities]:
    varied = [[(scene(kind, **of, **{n: v + STEP * abs(v)}), STEP * abs(v))] for n, v in GIVEN.items()]
    s = Sensitivities(varied, 1e-7)
    kept = Kept(s, nodal)
    result = Run(scene(kind, **of), [s, kept], Options(threads=threads)).solve()
    assert result.converged, result.reason
    assert not any(v.lost for v in s.all), [v.lost for v in s.all]
    return kept.values, s


def assert_same(a: list[Any], b: list[Any]) -> None:
    assert len(a) == len(b) > 40
    for x, y in zip(a, b):
        assert np.abs(x - y).max(initial=0.0) <= 2e-5 * max(np.abs(y).max(initial=0.0), 1e-3)
    assert np.abs(b[-2]).max() > 1e-3


@pytest.mark.parametrize(
    ("kind", "of"),
    [("hex8", {}), ("tet4", {}), ("penta6", {}), ("hex8", {"analysis": DYNAMIC}), ("hex8", {"viscous": True})],
)
def test_elements_beside_the_runs(kind: str, of: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """Nodal values and reactions over two analysis steps; histories and loads follow by themselves."""
    beside, s = derivatives(kind, **of)
    assert all(v.beside for v in s.all)
    nodal, _ = derivatives(kind, nodal=True, **of)
    monkeypatch.setattr(Beside, "serves", lambda self, v: False)
    own, plain = derivatives(kind, **of)
    assert not any(v.beside for v in plain.all)
    assert all(v.rides != bool(of) for v in s.all)
    assert_same(beside, own)
    assert_same(nodal, own)
    assert s.passes <= 1.1 * plain.passes
    for v, w in zip(s.all, plain.all):
        np.testing.assert_allclose(v.grown, w.grown, rtol=0, atol=2e-5 * max(np.abs(w.grown).max(), 1e-3))


def test_threads_share_the_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    one, _ = derivatives("hex8")
    monkeypatch.setattr("febkit.solver.schedule.LEAST", 1)
    two, s = derivatives("hex8", threads=2)
    assert s.all[0].base.schedule.n == 2
    assert_same(one, two)


def test_records_that_are_alike() -> None:
    a, b = scene("hex8").blocks, scene("hex8").blocks
    assert all(alike((p.solid, p.physics), (q.solid, q.physics)) for p, q in zip(a, b))
    assert not alike(a[0].solid, scene("hex8", E=1.0 + 1e-12).blocks[0].solid)
    assert not alike(a[0].solid, a[1].solid)
    assert alike(LoadCurve([(0, 0), (1, 1)]), LoadCurve([(0, 0), (1, 1)]))
    assert not alike(LoadCurve([(0, 0), (1, 1)]), LoadCurve([(0, 0), (1, 2)]))
    assert alike(Map(np.ones(3)), Map(np.ones(3)))
    assert not alike(Map(np.ones(3)), Map(np.ones(4)))
    slopes = [lambda t, k=k: k * t for k in (1.0, 1.0, 2.0)]
    assert alike(slopes[0], slopes[1])
    assert not alike(slopes[0], slopes[2])
    assert not alike(object(), object())
