"""Factorisations of single precision, and those of earlier tangents, leave Newton's iterations as they are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from febkit.solver import inverse, route
from febkit.solver.clock import Clock
from febkit.solver.inverse import FRESH, LEANING, REFINED, Inverse
from febkit.solver.linear.base import Matrix
from febkit.solver.linear.krylov import Recycled
from febkit.solver.linear.pardiso import Pardiso, library
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.permeabilities.holmes_mow import HolmesMow as HolmesMowPermeability
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.physics.three_field import ThreeField
from febkit.solver.problem import TRANSIENT, Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.run import Run
from febkit.solver.solids.mooney_rivlin import MooneyRivlin
from febkit.solver.solids.neo_hookean import NeoHookean
from helpers import scenes

pytestmark = pytest.mark.skipif(library() is None, reason="MKL is not installed")

PARDISO = Options(threads=1, linear="pardiso")


def pressed(solid: Any, physics: Any = None, **step: Any) -> Problem:
    """A cube of 64 hexahedra pressed by a fifth in four steps, its free sides drained."""
    X, conn = scenes.box("hex8", (4, 4, 4))
    low, high = (np.flatnonzero(np.abs(X[:, 2] - z) < 1e-9) for z in (0.0, 1.0))
    held: list[Any] = [*(Fixed(c, low) for c in range(3)), Prescribed(2, high, scenes.ramp(-0.2, 1.0))]
    if physics is not None and physics.name == "biphasic":
        held.append(Fixed(3, np.flatnonzero(X[:, 0] > 1 - 1e-9)))
    return Problem(X, [scenes.block("hex8", conn, solid, physics)], [Step(dt=0.25, count=4, conditions=held, **step)])


FULL = NewtonOptions(method="full Newton", updates=0)
SCENES: dict[str, Callable[[], Problem]] = {
    "solid": lambda: pressed(NeoHookean(1.0, 0.3)),
    "full Newton": lambda: pressed(NeoHookean(1.0, 0.3), newton=FULL),
    "nearly incompressible": lambda: pressed(MooneyRivlin(1.0, 0.2, k=500.0), ThreeField()),
    "fluid in equal steps": lambda: pressed(NeoHookean(1.0, 0.3), Biphasic(ConstIso(0.1)), analysis=TRANSIENT),
    "unsymmetric": lambda: pressed(
        NeoHookean(1.0, 0.3), Biphasic(HolmesMowPermeability(perm=0.1, M=2.0, alpha=2.0)), analysis=TRANSIENT
    ),
}  # fmt: skip


def solved(make: Callable[[], Problem], factor: str = "auto") -> Run:
    run = Run(make(), [], replace(PARDISO, factor=factor))
    assert run.solve().converged
    return run


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small models go the way of large ones."""
    monkeypatch.setattr(route, "REUSE_EQUATIONS", 0)
    monkeypatch.setattr(route, "POROUS_EQUATIONS", 0)


@pytest.mark.parametrize("dear", [False, True])
@pytest.mark.parametrize("name", SCENES)
def test_iterations_and_answers_are_those_of_fresh_factorisations(
    name: str, dear: bool, small: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = solved(SCENES[name], "fresh")
    if dear:
        monkeypatch.setattr(Inverse, "ratio", property(lambda self: 60.0))
    run = solved(SCENES[name])
    assert run.newton.inverse.use == REFINED
    assert (run.totals.steps, run.totals.iterations) == (exact.totals.steps, exact.totals.iterations)
    for f in run.state.layout.fields:
        d, e = (run.state.layout.view(r.state.d, f.name) for r in (exact, run))
        assert np.linalg.norm(e - d) < 1e-6 * np.linalg.norm(d)
    assert run.totals.reforms < exact.totals.reforms if dear else run.totals.reforms == exact.totals.reforms


def adrift() -> Problem:
    """A cube stretched by two pairs of faces; nothing holds it along z."""
    X, conn = scenes.box("hex8", (4, 4, 4), distort=0.2)
    held: list[Any] = [
        Prescribed(c, np.flatnonzero(np.abs(X[:, c] - end) < 1e-9), scenes.ramp(0.1 * (2.0 * end - 1.0), 1.0))
        for c in (0, 1)
        for end in (0.0, 1.0)
    ]
    return Problem(X, [scenes.block("hex8", conn, NeoHookean(1.0, 0.3))], [Step(dt=0.25, count=4, conditions=held)])


@pytest.mark.parametrize("dear", [False, True])
def test_a_motion_that_nothing_holds_is_that_of_fresh_factorisations(
    dear: bool, small: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = solved(adrift, "fresh")
    assert exact.newton.inverse.solver.stats["perturbed_pivots"] == 1
    if dear:
        monkeypatch.setattr(Inverse, "ratio", property(lambda self: 60.0))
    run = solved(adrift)
    assert run.totals.iterations == exact.totals.iterations
    np.testing.assert_allclose(run.state.u, exact.state.u, rtol=0.0, atol=1e-6)


def test_contact_and_small_models_are_solved_as_they_were() -> None:
    assert solved(SCENES["solid"]).newton.inverse.use == FRESH


def test_small_mixtures_are_solved_as_they_were(monkeypatch: pytest.MonkeyPatch) -> None:
    """Solids of their size are not."""
    monkeypatch.setattr(route, "REUSE_EQUATIONS", 0)
    assert solved(SCENES["fluid in equal steps"]).newton.inverse.use == FRESH
    assert solved(SCENES["solid"]).newton.inverse.use == REFINED


def test_full_newton_leans_on_nothing() -> None:
    run = Run(pressed(NeoHookean(1.0, 0.3), newton=FULL), [], Options(threads=1, linear="pardiso", factor="reuse"))
    assert run.solve().converged and run.newton.inverse.use == REFINED


def bent() -> Problem:
    """A bar a hundred times as long as thick, bent: its softest motion is 1e-9 of its stiffest."""
    X, conn = scenes.grid((2, 2, 100), (0.01, 0.01, 1.0))
    low, high = (np.flatnonzero(np.abs(X[:, 2] - z) < 1e-9) for z in (0.0, 1.0))
    held: list[Any] = [*(Fixed(c, low) for c in range(3)), Prescribed(0, high, scenes.ramp(0.01, 1.0))]
    newton = NewtonOptions(min_residual=0.0)  # its forces are less than the usual least residual
    step = Step(dt=0.5, count=2, conditions=held, newton=newton)
    return Problem(X, [scenes.block("hex8", conn, NeoHookean(1.0, 0.3))], [step])


def test_what_single_precision_does_not_resolve_is_factorised_in_double(small: None) -> None:
    run = solved(bent)
    assert not run.newton.inverse.use.single and run.newton.inverse.use.exact == REFINED.exact
    assert not run.newton.inverse.solver.single


def test_or_iterated_where_memory_is_short(small: None, monkeypatch: pytest.MonkeyPatch) -> None:
    exact = solved(bent)
    monkeypatch.setattr(route, "REFINED", replace(REFINED, doubles=False))
    run = solved(bent)
    assert run.newton.inverse.solver.single and run.totals.reforms == exact.totals.reforms
    assert run.totals.iterations == exact.totals.iterations
    assert np.linalg.norm(run.state.d - exact.state.d) < 1e-6 * np.linalg.norm(exact.state.d)


def test_memory_for_double_precision_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a factorisation of single precision that fits just so."""
    monkeypatch.setattr(route, "REUSE_EQUATIONS", 0)
    monkeypatch.setattr(route, "POROUS_EQUATIONS", 0)
    uses = []
    for share in (1.5, 2.5):
        run = Run(SCENES["solid"](), [], Options(threads=1, memory=1.0))
        monkeypatch.setattr(Pardiso, "memory", lambda self, A, share=share: 1e9 / share)
        monkeypatch.setattr("febkit.solver.linear.choose.DENSE_LIMIT", 0)
        assert run.solve().converged
        uses.append(run.newton.inverse.use.doubles)
    assert uses == [False, True]


# ---- rent or buy ----------------------------------------------------------------------------------


class Counted:
    """A dense solver of double precision that counts; a factorisation costs ten solves."""

    name, single = "counted", False

    def __init__(self) -> None:
        self.stats: dict[str, float] = {"equations": 1.0, "factor_entries": 170.0 * 10.0**0.5}
        self.factors = self.solves = 0

    def factor(self, A: Matrix) -> None:
        self._inverse = np.linalg.inv(dense(A))
        self.factors += 1

    def solve(self, b: Any) -> Any:
        self.solves += 1
        return self._inverse @ b

    def close(self) -> None: ...


def dense(A: Matrix) -> Any:
    rows = np.repeat(np.arange(A.n), np.diff(A.indptr))
    full = np.zeros((A.n, A.n))
    full[rows, A.indices] = A.data
    return full


def tangent(seed: int, spread: float, n: int = 60) -> Matrix:
    """The unit matrix and a random part."""
    full = np.eye(n) + spread * np.random.default_rng(seed).normal(size=(n, n)) / n**0.5
    rows, columns = np.nonzero(full)
    indptr = np.searchsorted(rows, np.arange(n + 1)).astype(np.int32)
    return Matrix(indptr, columns.astype(np.int32), full[rows, columns].copy(), False)


def took(spread: float, tangents: int, systems: int) -> tuple[Inverse, Counted]:
    """Solve so many systems of each of so many tangents."""
    solver = Counted()
    inv = Inverse(lambda: solver, Clock(), REFINED)  # type: ignore[arg-type,return-value]
    rng = np.random.default_rng(7)
    for k in range(tangents):
        A = tangent(k, spread)
        if not inv.approach(A, 1.0):
            inv.factorise(A, 1.0)
        for _ in range(systems):
            x = rng.normal(size=A.n)
            assert np.linalg.norm(inv.solve(dense(A) @ x) - x) < 1e-4 * np.linalg.norm(x)
    return inv, solver


def test_a_factorisation_serves_tangents_that_are_near() -> None:
    inv, solver = took(1e-4, 20, 3)
    assert solver.factors < 6 and inv._vain == 0


def test_no_tangent_costs_much_more_than_a_factorisation() -> None:
    """Of tangents that are far from each other each is factorised; fewer and fewer are tried otherwise first."""
    _, solver = took(0.2, 20, 8)
    assert solver.factors == 20
    assert solver.solves < 20 * 8 + 5 * (10 + 10)


def test_errors_count_field_by_field() -> None:
    """Pressures that are a millionth of displacements are as exact as these, if they alone need iterations."""
    rng = np.random.default_rng(3)
    size = np.where(np.arange(60) < 40, 1.0, 1e-6)
    full = dense(tangent(1, 0.3)) / size
    full[:40, 40:] = full[40:, :40] = 0.0
    old = np.where(size == 1.0, full, dense(tangent(2, 0.3)) / size)
    old[:40, 40:] = 0.0
    A = Matrix(np.arange(0, 3601, 60, dtype=np.int32), np.tile(np.arange(60, dtype=np.int32), 60), full.ravel(), False)
    x, off = size * rng.normal(size=60), {}
    for fields in ((), (np.arange(40), np.arange(40, 60))):
        y, error = Recycled(A, lambda r: np.linalg.solve(old, r), fields=fields).solve(full @ x, 1e-5, 60)
        assert error <= 1e-5
        off[len(fields)] = np.linalg.norm((y - x)[40:]) / np.linalg.norm(x[40:])
    assert off[2] < 1e-4 < off[0]


def test_uses() -> None:
    assert LEANING.leans and not REFINED.leans and not FRESH.exact
    assert inverse.Use() == FRESH
