"""A factorisation kept over time steps gives the answer that fresh ones give, with fewer of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import forecast, inverse
from febkit.solver.linear.base import Matrix
from febkit.solver.linear.krylov import Recycled, gmres, matvec
from febkit.solver.options import Options
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import TRANSIENT, Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.quasi_newton import Anderson
from febkit.solver.run import Run, run
from febkit.solver.sensitivity import Sensitivities
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.values import Constant, Scaled
from helpers import scenes
from helpers.scenes import UX, UY, UZ, P


def relaxing(n: int = 4, E: float = 1.0, perm: float = 0.05, tolerance: float = 1e-4) -> Problem:
    """Confined stress relaxation of a biphasic column, fixed steps."""
    from febkit.solver.permeabilities.const_iso import ConstIso
    from febkit.solver.problem import Block

    X, conn = scenes.grid((n, n, n))
    top = np.flatnonzero(X[:, 2] > 1 - 1e-9)
    holds: list[Any] = [Fixed(k, np.flatnonzero((X[:, k] < 1e-9) | (X[:, k] > 1 - 1e-9))) for k in (UX, UY)]
    ramp = Scaled(Constant(-0.1), lambda t: min(t / 1.0, 1.0))
    conditions = [
        *holds, Fixed(UZ, np.flatnonzero(X[:, 2] < 1e-9)), Prescribed(UZ, top, ramp), Fixed(P, top),
    ]  # fmt: skip
    block = Block("column", "hex8", conn, np.arange(1, len(conn) + 1), NeoHookean(E=E, v=0.2),
                  Biphasic(ConstIso(perm=perm)))  # fmt: skip
    newton = NewtonOptions(dtol=tolerance, etol=1e-4 * tolerance, ptol=tolerance)
    step = Step(analysis=TRANSIENT, dt=0.1, count=30, newton=newton, conditions=conditions)
    return Problem(X, [block], [step])


def test_reuse_gives_the_same_answer_with_fewer_factorisations():
    fresh = run(relaxing(), options=Options(threads=1, factor="fresh"))
    kept = run(relaxing(), options=Options(threads=1, factor="reuse"))
    assert fresh.converged and kept.converged
    assert kept.totals.reforms < 0.7 * fresh.totals.reforms
    assert kept.totals.steps == fresh.totals.steps
    d, e = fresh.state.d, kept.state.d
    assert np.linalg.norm(e - d) < 1e-4 * np.linalg.norm(d)


def test_derivatives_of_runs_that_keep_factorisations() -> None:
    """Against central differences of whole runs; steps are foretold, and a correction by an old factorisation does."""
    amounts = {"E": 1e-6, "perm": 0.05e-6}
    varied = [[(relaxing(**{n: v + amounts[n]}), amounts[n])] for n, v in (("E", 1.0), ("perm", 0.05))]
    s = Sensitivities(varied)
    base = Run(relaxing(), [s], Options(threads=1, factor="reuse"))
    assert base.solve().converged and not any(v.lost for v in s.all)
    assert s.passes <= 1.5 * 2 * base.totals.steps  # 3 factorisations serve 30 steps
    assert s.passes + base.totals.residuals < 7.5 * base.totals.steps
    for k, (name, v) in enumerate((("E", 1.0), ("perm", 0.05))):
        h = 1e-4 * v
        ends = [run(relaxing(**{name: v + w, "tolerance": 1e-8}), options=Options(threads=1)).state.d for w in (h, -h)]
        wanted = (ends[0] - ends[1]) / (2 * h)
        found = s.of(k, lambda r: r.state.d)
        for field in (slice(0, 3), slice(3, 4)):
            off = np.linalg.norm((found - wanted)[:, field])
            assert off < 2e-3 * np.linalg.norm(wanted[:, field]), (name, field)


def _spd(n: int = 60, seed: int = 1) -> tuple[Matrix, np.ndarray]:
    rng = np.random.default_rng(seed)
    B = rng.normal(size=(n, n)) * (rng.random((n, n)) < 0.15)
    full = B @ B.T + n * 0.1 * np.eye(n)
    upper = np.triu(full)
    rows, columns = np.nonzero(upper)
    indptr = np.searchsorted(rows, np.arange(n + 1)).astype(np.int32)
    return Matrix(indptr, columns.astype(np.int32), upper[rows, columns].copy(), True), full


def _rows(A: Matrix) -> np.ndarray:
    return np.repeat(np.arange(A.n), np.diff(A.indptr))


def test_product_with_upper_storage():
    A, full = _spd()
    x = np.random.default_rng(2).normal(size=A.n)
    np.testing.assert_allclose(matvec(A, x), full @ x, rtol=1e-12)


def test_gmres_with_an_old_factorisation():
    A, full = _spd()
    old = np.linalg.inv(full + np.diag(np.linspace(0, 3, A.n)))
    b = np.random.default_rng(3).normal(size=A.n)
    solves = []
    x, z, error = gmres(A, b, lambda r: solves.append(1) or old @ r, 1e-8, 40)
    assert error < 1e-8 and 1 < len(solves) < 40
    np.testing.assert_allclose(z, old @ b, rtol=1e-12)
    np.testing.assert_allclose(x, np.linalg.solve(full, b), rtol=1e-6, atol=1e-9)


def test_gmres_with_a_fresh_factorisation_takes_one_solve():
    A, full = _spd()
    fresh = np.linalg.inv(full).astype(np.float32).astype(float)
    solves = []
    b = np.random.default_rng(3).normal(size=A.n)
    x, _, error = gmres(A, b, lambda r: solves.append(1) or fresh @ r, 0.03, 12)
    assert error < 0.03 and len(solves) == 1
    np.testing.assert_allclose(x, np.linalg.solve(full, b), rtol=1e-4, atol=1e-6)


def test_directions_serve_later_systems():
    A, full = _spd()
    old = np.linalg.inv(full + np.diag(np.linspace(0, 3, A.n)))
    b = np.random.default_rng(3).normal(size=A.n)
    one = Recycled(A, lambda r: old @ r)
    x, error = one.solve(b, 1e-8, 40)
    first = one.solves
    np.testing.assert_allclose(x, np.linalg.solve(full, b), rtol=1e-6, atol=1e-9)
    assert error <= 1e-8 and first > 5
    _, alone = gmres(A, b, lambda r: old @ r, 1e-8, first - 1)[1:]
    assert alone <= 1e-8  # the same least residuals as GMRES's
    x, error = one.solve(full @ (2.0 * x + 0.1 * old @ b), 1e-8, 40)
    assert error <= 1e-8 and one.solves - first <= first // 2
    np.testing.assert_allclose(x, 2.0 * np.linalg.solve(full, b) + 0.1 * old @ b, rtol=1e-6, atol=1e-8)


def test_few_directions_are_kept():
    A, full = _spd()
    old = np.linalg.inv(full + np.diag(np.linspace(0, 3, A.n)))
    one = Recycled(A, lambda r: old @ r, keep=3)
    b = np.random.default_rng(3).normal(size=A.n)
    x, error = one.solve(b, 1e-8, 40)
    assert error <= 1e-8 and len(one._pairs) == 3
    np.testing.assert_allclose(x, np.linalg.solve(full, b), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("b", [0.0, 1e200])
def test_nothing_and_too_much(b):
    A, full = _spd()
    x, error = Recycled(A, lambda r: np.linalg.solve(full, r)).solve(np.full(A.n, b), 1e-3, 5)
    assert (error, x.any()) == (0.0, False) if b == 0.0 else error == np.inf


def test_a_factorisation_tires():
    """Renewed once a tangent takes more than the mean: k solves more for the k-th, cost C: after about (2 C)^0.5."""
    f = inverse.Factor(1.0, None)
    while not f.tired(50.0):
        f.tangents, f.latest, f.extra = f.tangents + 1, f.tangents, f.extra + f.tangents
    assert f.tangents == 11


def test_dear_factorisations_serve_other_tangents(monkeypatch):
    monkeypatch.setattr(inverse.Inverse, "ratio", property(lambda self: 60.0))
    fresh = run(relaxing(), options=Options(threads=1, factor="fresh"))
    kept = run(relaxing(), options=Options(threads=1, factor="reuse"))
    assert kept.totals.steps == fresh.totals.steps and kept.totals.reforms < 0.2 * fresh.totals.reforms
    assert np.linalg.norm(kept.state.d - fresh.state.d) < 1e-4 * np.linalg.norm(fresh.state.d)


def test_steps_begin_where_the_last_ones_led(monkeypatch):
    """The same answer in fewer iterations; of some steps the guess is taken, at the end of the ramp it is not."""
    taken, ends = [], []
    call = forecast.Guess.__call__

    def watched(self, dt, given):
        out = call(self, dt, given)
        taken.append(out is not None)
        return out

    for told in (watched, lambda self, dt, given: None):
        monkeypatch.setattr(forecast.Guess, "__call__", told)
        ends.append(run(relaxing(), options=Options(threads=1, factor="reuse")))
    guessed, plain = ends
    assert guessed.totals.steps == plain.totals.steps == len(taken)
    assert sum(taken) > 10 and not any(taken[:2]) and not taken[10]  # the ramp ends after ten steps
    assert guessed.totals.iterations < 0.9 * plain.totals.iterations
    assert np.linalg.norm(guessed.state.d - plain.state.d) < 1e-4 * np.linalg.norm(plain.state.d)


def test_a_guess_that_turns_elements_inside_out_is_dropped(monkeypatch):
    plain = run(relaxing(), options=Options(threads=1, factor="reuse"))
    call = forecast.Guess.__call__

    def wild(self, dt, given):
        out = call(self, dt, given)
        return out if out is None else -100.0 * out

    monkeypatch.setattr(forecast.Guess, "__call__", wild)
    kept = run(relaxing(), options=Options(threads=1, factor="reuse"))
    assert kept.converged and kept.totals.steps == plain.totals.steps
    assert np.linalg.norm(kept.state.d - plain.state.d) < 1e-4 * np.linalg.norm(plain.state.d)


def test_fields_count_alike():
    """A direction by an old factorisation is right in each field, however small its numbers are."""
    A, full = _spd()
    units = np.where(np.arange(A.n) < 30, 1.0, 1e-6)  # of forces: the first unknowns come out a million times smaller
    small = Matrix(A.indptr, A.indices, A.data * units[_rows(A)] * units[A.indices], True)
    old = np.linalg.inv(full + np.diag(np.linspace(0, 30, A.n))) / np.outer(units, units)
    b = units * np.random.default_rng(3).normal(size=A.n)
    exact = np.linalg.solve(full, b / units) / units
    fields = [np.arange(30), np.arange(30, A.n)]
    found = [gmres(small, b, lambda r: old @ r, 0.03, 40, own)[0] for own in (fields, [])]
    wrong = [np.linalg.norm(x[:30] - exact[:30]) / np.linalg.norm(exact[:30]) for x in found]
    assert wrong[0] < 0.03 and wrong[1] > 0.1


@pytest.mark.parametrize("stiffer", [0.5, 2.0])
def test_anderson_solves_a_linear_system_with_a_wrong_inverse(stiffer):
    _, full = _spd(20)
    wrong = np.linalg.inv(full * stiffer + np.diag(np.linspace(0, 1, 20)))
    qn = Anderson(lambda r: wrong @ r, NewtonOptions(), keep=25)
    b = np.random.default_rng(4).normal(size=20)
    x, R = np.zeros(20), b.copy()
    for _ in range(25):
        u = qn.solve(R)
        x = x + u
        R1 = b - full @ x
        qn.update(1.0, u, R, R1)
        R = R1
        if np.linalg.norm(R) < 1e-10 * np.linalg.norm(b):
            break
    assert np.linalg.norm(R) < 1e-8 * np.linalg.norm(b)
