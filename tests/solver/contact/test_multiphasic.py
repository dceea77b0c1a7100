"""Contacts of mixtures: tangents against differences, what passes, what a bath holds, automatic penalties."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import contact, permeabilities, physics
from febkit.solver.contact.penalty import automatic, conductance
from febkit.solver.contact.penalty import mixture as of_mixtures
from febkit.solver.contact.surface import Surface
from febkit.solver.fields import concentration
from febkit.solver.group import Group
from febkit.solver.problem import STEADY, TRANSIENT, Block, Fixed, Initial, Prescribed, Problem, Step
from febkit.solver.state import State
from febkit.solver.values import Constant
from helpers import pair as scene
from helpers import scenes
from helpers.mixture_element import mixture, solute

TYPES = ["sliding-biphasic-solute", "sliding-multiphasic", "tied-multiphasic"]
P, C1, C2 = 3, 4, 5
ZERO = Constant(0.0)


def pair(*charges: int, **kw: Any) -> scene.Pair:
    """Two blocks of a mixture with solutes of these charges."""
    solutes = tuple(solute(i, z) for i, z in enumerate(charges))
    perm = permeabilities.load("perm-const-iso")(perm=0.4)
    mix = mixture(solutes, permeability=perm, fixed_charge=ZERO, model_solutes=len(charges))
    return scene.Pair(physics=physics.load("multiphasic")(mix), **kw)


def make(name: str, p: scene.Pair, **kw: Any) -> Any:
    return contact.load(name)(**p.sides, **kw)


@pytest.mark.parametrize("name", TYPES)
def test_tangent_is_the_derivative(name: str) -> None:
    p = pair(0, 0, skew=0.1, inset=0.05)
    extra = {"symmetric_stiffness": False} if name.startswith("tied") else {}
    c = make(name, p, penalty=3.0, pressure_penalty=2.0, concentration_penalty=1.5, auto_penalty=True, **extra)
    state = scene.started(p, c)
    rng = np.random.default_rng(8)
    d = rng.uniform(-0.02, 0.02, (len(p.X), 6))
    d[np.unique(p.upper), 2] -= 0.06
    d[:, 3:] = rng.uniform(-0.3, 0.3, (len(p.X), 3))
    R = scene.forces(c, state, d)
    assert np.abs(R[:, 3:]).max(axis=0).min() > 1e-4
    assert np.abs(R.sum(axis=0)).max() < 1e-12  # what one surface loses the other gains
    K, D = scene.stiffness(c, state), scene.difference(c, state, d)
    for column in range(3, 6):
        rows = np.arange(K.shape[0]) % 6 == column
        assert np.abs((K - D)[rows]).max() < 1e-6 * np.abs(K[rows]).max()
    assert np.abs(K - D).max() < 1e-6 * np.abs(K).max()


def diffuses(problem: Problem) -> Problem:
    """Concentrations 1 below and 3 above, pressures 0, no displacement but along z; a steady state."""
    X, step = problem.X, problem.steps[0]
    everywhere = np.arange(len(X))
    bottom, top = (np.flatnonzero(np.abs(X[:, 2] - z) < 1e-9) for z in (0.0, X[:, 2].max()))
    step.analysis = STEADY
    step.conditions += [Fixed(k, everywhere) for k in (0, 1)]
    step.conditions += [Prescribed(P, np.r_[top, bottom], ZERO)]
    step.conditions += [Prescribed(C1, top, Constant(3.0)), Prescribed(C1, bottom, Constant(1.0))]
    return problem


@pytest.mark.parametrize("name", TYPES)
def test_solutes_diffuse_through_the_contact_as_through_one_block(name: str) -> None:
    tight = {"dtol": 1e-9, "ptol": 1e-9, "ctol": 1e-9}
    p = pair(0, n=4)
    c = make(name, p, penalty=1e4, pressure_penalty=1e4, concentration_penalty=1e4)
    d = scene.solve(diffuses(p.problem(c, -1e-2, **tight))).state.d
    X, conn = scenes.grid((1, 1, 4), (1.0, 1.0, 2.0))
    block = Block("whole", "hex8", conn, np.arange(1, 5), p.blocks[0].solid, p.blocks[0].physics)
    below, above = (np.flatnonzero(np.abs(X[:, 2] - z) < 1e-9) for z in (0.0, 2.0))
    step = Step(dt=1.0, count=1, newton=scenes.tight(**tight))
    step.conditions = [Fixed(2, below), Prescribed(2, above, Constant(-1e-2))]
    whole = scene.solve(diffuses(Problem(X, [block], [step]))).state.d
    middle = whole[np.abs(X[:, 2] - 1.0) < 1e-9]
    for side in (p.upper, p.lower):
        met = d[np.unique(side)]
        assert met[:, C1] == pytest.approx(middle[0, C1], rel=1e-3)
        assert met[:, P] == pytest.approx(middle[0, P], rel=1e-3)
    assert abs(middle[0, C1] - 2.0) > 0.01  # what flows carries solute along


@pytest.mark.parametrize("name", TYPES[:2])
def test_a_bath_holds_what_touches_nothing(name: str) -> None:
    p = pair(1, -1, n=4, inset=0.2)
    bath = {concentration(1).name: 0.8, concentration(2).name: 0.7}
    c = make(
        name, p, penalty=100.0, pressure_penalty=10.0, concentration_penalty=10.0, ambient_pressure=-0.2,
        ambient_concentration=bath,
    )  # fmt: skip
    problem = p.problem(c, -2e-2, dtol=1e-8, ptol=1e-8, ctol=1e-8)
    step = problem.steps[0]
    step.analysis, step.dt, step.count = TRANSIENT, 0.1, 2
    everywhere = np.arange(len(p.X))
    step.conditions += [Fixed(k, everywhere) for k in (0, 1)]
    problem.common.initial = [Initial(k, everywhere, Constant(0.75)) for k in (C1, C2)]
    d = scene.solve(problem).state.d
    middle = np.flatnonzero((np.abs(p.X - [0.5, 0.5, 1.0]) < 1e-9).all(axis=1))
    rim = np.flatnonzero((np.abs(p.X[:, 2] - 1.0) < 1e-9) & (np.arange(len(p.X)) < p.n))
    rim = np.setdiff1d(rim, middle)
    assert np.all(d[rim, 3:] == [-0.2, 0.8, 0.7])
    assert np.abs(d[middle, 3:] - [-0.2, 0.8, 0.7]).min() > 1e-6


def test_automatic_penalties() -> None:
    """E A / V of the mixture's tangent at rest, k A / V, and phi kappa D A / V."""
    p = pair(1, -1)
    groups = [Group(b, p.X) for b in p.blocks]
    problem = p.problem(make("tied-multiphasic", p), 0.0)
    state = State.at_rest(problem)
    s = Surface(p.sides["primary"], p.X)
    depth = 0.5  # V / A of the elements
    solid = automatic(s, groups)
    assert conductance(s, groups, "fluid pressure") == pytest.approx(0.4 / depth)
    state.d[:, P], state.d[:, C1:] = -1.1 * 1.2 * 0.95 * 0.6 * 1.7, 0.6
    diffusion = conductance(s, groups, concentration(2).name)
    # a neutral bath: zeta makes both actual concentrations the geometric mean of solubilities times 0.6
    assert diffusion == pytest.approx((1.0 - 0.2) * 0.8 * 0.8 / depth)
    state.d[:, P] = -1.1 * 1.2 * 0.95 * 2.0 * np.sqrt(0.9 * 0.8) * 0.6
    assert of_mixtures(s, groups, state) == pytest.approx(solid)  # no pressure in all: the solid alone
    state.d[:, P] += 0.3
    E, v, pa = scene.E, scene.V, 0.3
    lame, mu = E * v / (1 + v) / (1 - 2 * v), E / 2 / (1 + v)
    C = lame - pa + (2 * mu + 2 * pa) * np.eye(3)
    assert of_mixtures(s, groups, state) == pytest.approx(1.0 / np.linalg.inv(C)[2, 2] / depth)
