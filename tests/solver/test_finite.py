"""No state with a number that is not finite is called converged or handed over, and the message says whose it is."""

from __future__ import annotations

from math import inf, nan
from typing import Any

import numpy as np
import pytest

from febkit.solver.finite import whole
from febkit.solver.linear.base import Matrix
from febkit.solver.linear.krylov import gmres
from febkit.solver.loads.body_force import BodyForce
from febkit.solver.options import Options
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.permeabilities.holmes_mow import HolmesMow
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import TRANSIENT, AutoStep, Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.run import Listener, Run, run
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.solids.solid_mixture import SolidMixture
from febkit.solver.values import Expression, Map
from helpers import scenes
from helpers.scenes import UX, UZ, P

OPTIONS = Options(threads=1, linear="dense")


class Saved(Listener):
    """Keeps what is handed over."""

    def __init__(self) -> None:
        self.states: list[Any] = []

    def save(self, run: Run, status: int) -> None:
        self.states.append(run.state.snapshot())


def cube(solid: Any, mixture: Any = None, driven: bool = True, force: float = 0.0, **step: Any) -> Problem:
    """Two elements; all nodes prescribed to a uniform strain, or free above a fixed base."""
    X, conn = scenes.box("hex8", (1, 1, 2))
    base = np.flatnonzero(X[:, 2] < 1e-9)
    conditions: list[Any] = [Fixed(c, base) for c in range(UX, UZ + 1)]
    if driven:
        conditions = [*scenes.prescribe(np.arange(len(X)), 0.1 * X)]
        if mixture is not None:
            conditions.append(Fixed(P, np.arange(len(X))))
    loads = [BodyForce((0.0, 0.0, force))] if force else []
    how: dict[str, Any] = {"dt": 0.5, "count": 2, **step}
    if mixture is not None:
        how["analysis"] = TRANSIENT
    first = Step(**how, newton=NewtonOptions(), conditions=conditions, body_loads=loads)
    return Problem(X, [scenes.block("hex8", conn, solid, mixture)], [first])


def refused(problem: Problem, *words: str) -> None:
    """The run ends unconverged, says ``words``, and hands over finite states alone."""
    kept = Saved()
    result = run(problem, [kept], OPTIONS)
    assert not result.converged
    for word in words:
        assert word in result.reason, result.reason
    assert all(np.isfinite(s["d"]).all() and np.isfinite(s["reaction"]).all() for s in kept.states)
    assert np.isfinite(result.state.d).all(), "what is handed back is the last good state"


@pytest.mark.parametrize("bad", [nan, inf])
@pytest.mark.parametrize("driven", [True, False])
def test_a_parameter_that_is_not_finite_is_named(bad: float, driven: bool) -> None:
    """With all nodes prescribed there is no residual at a free unknown that would show it."""
    refused(cube(NeoHookean(bad, 0.3), driven=driven), "element 1 of part 'part'", f"its parameter E is {bad:g}")
    mapped = NeoHookean(Map(np.array([1.0, bad])), 0.3)
    refused(cube(mapped, driven=driven), "element 2 of part 'part'", f"E is {bad:g}")
    both = SolidMixture([NeoHookean(1.0, 0.3), NeoHookean(1.0, bad)])
    refused(cube(both, driven=driven), f"its parameter solid.v is {bad:g}")


def test_a_formula_that_fails_at_a_place_or_a_time_is_named() -> None:
    at_place = Expression(lambda X, Y, Z, t: np.sqrt(0.7 - Z), steady=True)
    refused(cube(NeoHookean(at_place, 0.3)), "element 2 of part 'part'", "E is nan")
    later = Expression(lambda X, Y, Z, t: np.sqrt(np.array([0.7 - t])))
    refused(cube(NeoHookean(later, 0.3)), "E is nan", "at time 1")


@pytest.mark.parametrize("mixture", [
    Biphasic(ConstIso(nan)), Biphasic(ConstIso(1.0), Map(np.array([0.2, nan]))), Biphasic(HolmesMow(1.0, inf, 0.2)),
])  # fmt: skip
def test_no_first_state_holds_a_flux_that_is_not_finite(mixture: Any) -> None:
    kept = Saved()
    result = run(cube(NeoHookean(1.0, 0.3), mixture, auto=AutoStep()), [kept], OPTIONS)
    assert not result.converged and "its parameter" in result.reason and not kept.states


@pytest.mark.parametrize("value", [nan, inf])
def test_a_prescribed_value_that_is_not_finite_is_named(value: float) -> None:
    problem = cube(NeoHookean(1.0, 0.3))
    problem.node_ids = np.arange(len(problem.X)) + 101
    problem.steps[0].conditions.append(Prescribed(UX, np.array([3]), scenes.ramp(value, 1.0)))
    refused(problem, f"the x displacement prescribed on node 104 is {value:g}")


@pytest.mark.parametrize("auto", [None, AutoStep(max_retries=2)])
def test_norms_that_overflow_are_no_sign_of_convergence(auto: Any) -> None:
    """inf <= tolerance * inf holds."""
    refused(cube(NeoHookean(1.0, 0.3), driven=False, force=1e300, auto=auto))
    refused(cube(NeoHookean(1e200, 0.3), driven=False, force=1e199), "overflows")


def test_a_load_that_is_not_finite_is_named() -> None:
    refused(cube(NeoHookean(1.0, 0.3), driven=False, force=nan), "the forces of body load 1 (BodyForce) are not finite")


def test_stresses_beyond_doubles_are_named() -> None:
    """The parameters are finite, the stress is not."""
    refused(cube(NeoHookean(1.7e308, 0.45)), "element 1 of part 'part'", "stress is not finite")


def test_one_sum_is_enough() -> None:
    a = np.zeros((50, 3))
    assert whole(a)
    with np.errstate(over="ignore"):
        assert whole(np.full(10, 1e308)), "a sum that overflows is looked at once more"
    for bad in (nan, inf, -inf):
        a[17, 1] = bad
        assert not whole(a)
    a[18, 2] = inf
    with np.errstate(invalid="ignore"):
        assert not whole(a), "inf - inf"


@pytest.mark.parametrize("size", [1e160, 1e200, 1e300])
def test_directions_too_large_for_their_squares_are_no_zero(size: float) -> None:
    """They are handed back, to be found too large, instead of ending the least squares or passing for no motion."""
    A = Matrix(np.array([0, 2, 4], np.int32), np.array([0, 1, 0, 1], np.int32), np.array([2.0, 1.0, 0.5, 3.0]), False)
    with np.errstate(over="ignore", invalid="ignore"):
        x, z, error = gmres(A, np.array([size, -size]), lambda b: b / 2.5, 0.03, 12)
    assert x.any() and not error < 0.03
    np.testing.assert_array_equal(x, z)
