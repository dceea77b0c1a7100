"""The solver used directly: methods agree, failures are told in words, interruption ends cleanly."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver.linear.base import LinearError, Matrix
from febkit.solver.linear.choose import choose
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.permeabilities.holmes_mow import HolmesMow
from febkit.solver.physics import default
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import STATIC, TRANSIENT, AutoStep, Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.run import Listener, Run, run
from febkit.solver.solids.isotropic_elastic import IsotropicElastic
from febkit.solver.solids.neo_hookean import NeoHookean
from helpers import scenes
from helpers.scenes import UX, UZ, P


def squeezed(newton: NewtonOptions, n: int = 3, top: float = -0.2, permeability: Any = None, **kw: Any) -> Problem:
    """A biphasic cube pressed between rough plates, drained at the sides."""
    X, conn = scenes.box("hex8", (n, n, n))
    low, high = np.flatnonzero(X[:, 2] < 1e-9), np.flatnonzero(X[:, 2] > 1 - 1e-9)
    side = np.flatnonzero((np.abs(X[:, :2] - 0.5) > 0.5 - 1e-9).any(axis=1))
    conditions: list[Any] = [Fixed(c, low) for c in range(UX, UZ + 1)] + [Fixed(c, high) for c in (0, 1)]
    conditions += [Fixed(P, side), Prescribed(UZ, high, scenes.ramp(top, 1.0))]
    step = Step(analysis=TRANSIENT, **{"dt": 0.25, "count": 4, **kw}, newton=newton, conditions=conditions)
    block = scenes.block("hex8", conn, NeoHookean(1.0, 0.2), Biphasic(permeability or ConstIso(0.1)))
    return Problem(X, [block], [step])


def close(**kw: Any) -> NewtonOptions:
    return NewtonOptions(**{"dtol": 1e-9, "etol": 1e-16, "ptol": 1e-9, "max_reforms": 50, "min_residual": 1e-28, **kw})


@pytest.fixture(scope="module")
def reference() -> Any:
    result = run(squeezed(close(method="full Newton", updates=0)), options=Options(threads=1))
    assert result.converged, result.reason
    return result.state


@pytest.mark.parametrize("method", ["BFGS", "Broyden"])
@pytest.mark.parametrize("updates", [3, 10])
def test_quasi_newton_gives_newtons_answer(method: str, updates: int, reference: Any) -> None:
    result = run(squeezed(close(method=method, updates=updates)), options=Options(threads=1))
    assert result.converged, result.reason
    np.testing.assert_allclose(result.state.d, reference.d, atol=2e-8)
    assert result.totals.reforms < result.totals.iterations


@pytest.mark.parametrize("law", [NeoHookean(1.0, 0.3), IsotropicElastic(1.0, 0.3)], ids=lambda m: type(m).__name__)
def test_newton_converges_quadratically(law: Any) -> None:
    """Exact tangents: the norm of the residual squares from one iteration to the next."""
    norms: list[float] = []

    class Watch(Listener):
        def iteration(self, run: Run, it: Any) -> None:
            norms.append(it.norms["residual"].now ** 0.5)

    p = squeezed(scenes.tight(dtol=1e-10, min_residual=1e-28), top=-0.1, count=1, dt=1.0)
    p.blocks[0].solid, p.blocks[0].physics = law, default()
    p.steps[0].analysis = STATIC
    p.steps[0].conditions = [c for c in p.steps[0].conditions if c.column != P]
    assert run(p, [Watch()], Options(threads=1)).converged
    orders = [np.log(c / b) / np.log(b / a) for a, b, c in zip(norms, norms[1:], norms[2:]) if c > 1e-13]
    assert max(orders) > 1.7, norms


@pytest.mark.parametrize("linear", ["pardiso", "superlu", "dense"])
@pytest.mark.parametrize("permeability", [ConstIso(0.1), HolmesMow(0.1, 1.0, 0.5)], ids=["symmetric", "unsymmetric"])
def test_linear_solvers_agree(linear: str, permeability: Any) -> None:
    def solve(name: str) -> Any:
        options = close(method="full Newton", updates=0)
        result = run(squeezed(options, 2, permeability=permeability), options=Options(threads=1, linear=name))
        assert result.converged, result.reason
        return result.state.d

    if linear == "pardiso":
        from febkit.solver.linear.pardiso import library

        if library() is None:
            pytest.skip("MKL is not installed here")
    np.testing.assert_allclose(solve(linear), solve("dense"), atol=1e-9)


def test_singular_systems_are_said_to_be_singular() -> None:
    A = Matrix(np.array([0, 2, 3], np.int32), np.array([0, 1, 1], np.int32), np.array([1.0, 1.0, 1.0]), True)
    for name in ("dense", "superlu"):
        with pytest.raises(LinearError, match="singular"):
            solver = choose(name, 2, 1)
            solver.factor(A)
            solver.solve(np.array([1.0, 0.0]))
    with pytest.raises(LinearError, match="unknown linear solver"):
        choose("qr", 2, 1)


def test_an_element_turned_over_is_named_with_part_and_time() -> None:
    result = run(squeezed(close(method="full Newton", updates=0, line_tolerance=0.0), 2, top=-1.5, count=1, dt=1.0),
                 options=Options(threads=1))
    assert not result.converged
    assert "element" in result.reason and "'part'" in result.reason and "at time 1" in result.reason
    assert np.isfinite(result.state.d).all(), "the last converged state is handed back"
    np.testing.assert_array_equal(result.state.d, 0.0)


def test_elements_turned_over_in_the_mesh_are_named() -> None:
    p = squeezed(close(), 2)
    p.blocks[0].conn = p.blocks[0].conn.copy()
    p.blocks[0].conn[3] = p.blocks[0].conn[3][[4, 5, 6, 7, 0, 1, 2, 3]]
    result = run(p, options=Options(threads=1))
    assert not result.converged and "element 4 of part 'part'" in result.reason


def test_retries_cut_the_step_and_go_on() -> None:
    """A step too large for the reformations it may have is cut; smaller ones carry on to the end."""

    options = close(method="full Newton", updates=0, max_reforms=4, dtol=1e-3, ptol=1e-3, etol=1e-4)
    told: list[float | None] = []

    class Watch(Listener):
        def failed(self, run: Run, reason: str, again: float | None) -> None:
            told.append(again)

    auto = AutoStep(dtmax=1.0, max_retries=8, optimal_iterations=8)
    result = run(squeezed(options, 2, top=-0.75, dt=1.0, duration=1.0, auto=auto), [Watch()], Options(threads=1))
    assert result.converged, result.reason
    assert result.totals.retries == len(told) > 0
    assert all(dt is not None and dt < 1.0 for dt in told)
    assert result.state.time == pytest.approx(1.0)


def test_too_few_reformations_are_reported() -> None:
    o = close(method="full Newton", updates=0, max_reforms=2)
    result = run(squeezed(o, 2, count=1, dt=1.0), options=Options(threads=1))
    assert not result.converged
    assert "reformations (2)" in result.reason and "at time 1" in result.reason


def test_interruption_hands_back_the_last_state() -> None:
    class Stop(Listener):
        def iteration(self, run: Run, it: Any) -> None:
            if it.time > 0.6:
                raise KeyboardInterrupt

    result = run(squeezed(close(), 2), [Stop()], Options(threads=1))
    assert not result.converged and result.interrupted and "interrupted" in result.reason
    assert result.times == pytest.approx([0.0, 0.25, 0.5])


def test_line_search_helps_a_large_step() -> None:
    """A step that plain Newton cannot take is taken with line search, or needs no more iterations."""
    count = {}
    for tolerance in (0.0, 0.9):
        o = close(method="full Newton", updates=0, line_tolerance=tolerance, line_check_jacobians=True, dtol=1e-6,
                  ptol=1e-6, etol=1e-10)
        result = run(squeezed(o, 2, top=-0.4, count=1, dt=1.0), options=Options(threads=1))
        count[tolerance] = result.totals.iterations if result.converged else 1000
    assert count[0.9] <= count[0.0]
    assert count[0.9] < 1000
