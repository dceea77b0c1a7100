"""Patch tests: every solid element reproduces affine displacements and linear pressures to round-off."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import elements
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.physics.three_field import ThreeField
from febkit.solver.problem import STEADY, Fixed, Problem, Step
from febkit.solver.run import Listener, Run, run
from febkit.solver.solids.mooney_rivlin import MooneyRivlin
from febkit.solver.solids.neo_hookean import NeoHookean
from helpers import scenes
from helpers.scenes import UX, UZ, P

A = np.array([(0.08, 0.05, -0.03), (-0.02, -0.06, 0.04), (0.03, 0.01, 0.05)])
G = np.array([0.3, -0.7, 0.4])


class Keep(Listener):
    """Keeps the element groups of a run."""

    def start(self, run: Run) -> None:
        self.groups = run.groups


def _solve(problem: Problem) -> tuple[Any, Keep]:
    keep = Keep()
    result = run(problem, [keep], Options(threads=1))
    assert result.converged, result.reason
    return result.state, keep


@pytest.mark.parametrize("kind", elements.VOLUMES)
def test_affine_displacement(kind: str) -> None:
    X, conn = scenes.box(kind, (2, 2, 2), 0.25)
    nodes = scenes.skin(X)
    assert len(nodes) < len(X)
    step = Step(dt=1.0, count=1, newton=scenes.tight(), conditions=scenes.prescribe(nodes, X[nodes] @ A.T))
    state, keep = _solve(Problem(X, [scenes.block(kind, conn, NeoHookean(1.0, 0.3))], [step]))
    np.testing.assert_allclose(state.u, X @ A.T, atol=1e-12)
    s = keep.groups[0].physics.s
    np.testing.assert_allclose(s, np.broadcast_to(s[0, 0], s.shape), atol=1e-12)


@pytest.mark.parametrize("kind", ["hex8", "penta6", "pyra5"])
def test_affine_displacement_of_three_field_elements(kind: str) -> None:
    X, conn = scenes.box(kind, (2, 2, 2), 0.25)
    nodes = scenes.skin(X)
    step = Step(dt=1.0, count=1, newton=scenes.tight(), conditions=scenes.prescribe(nodes, X[nodes] @ A.T))
    block = scenes.block(kind, conn, MooneyRivlin(1.0, 0.2, k=100.0), ThreeField())
    state, _ = _solve(Problem(X, [block], [step]))
    np.testing.assert_allclose(state.u, X @ A.T, atol=1e-12)


@pytest.mark.parametrize("kind", elements.VOLUMES)
def test_linear_pressure(kind: str) -> None:
    """Steady flow through a rigid skeleton: p linear, w = -k grad p everywhere."""
    X, conn = scenes.box(kind, (2, 2, 2), 0.25)
    nodes, p = scenes.skin(X), 1.0 + X @ G
    conditions: list[Any] = [Fixed(c, np.arange(len(X))) for c in range(UX, UZ + 1)]
    conditions += scenes.prescribe(nodes, p[nodes, None], P)
    step = Step(analysis=STEADY, dt=1.0, count=1, newton=scenes.tight(), conditions=conditions)
    block = scenes.block(kind, conn, NeoHookean(1.0, 0.3), Biphasic(ConstIso(0.2)))
    state, keep = _solve(Problem(X, [block], [step]))
    np.testing.assert_allclose(state.p, p, atol=1e-12)
    w = keep.groups[0].physics.w
    np.testing.assert_allclose(w, np.broadcast_to(-0.2 * G, w.shape), atol=1e-12)
