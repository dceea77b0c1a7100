"""Second-order steps: their order, what they save, and that the error asked for is the error met."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from febkit.solver.newton import Counts, Newton, NotConverged, Strategy
from febkit.solver.options import Options
from febkit.solver.problem import AutoStep, NewtonOptions, Prescribed, Problem
from febkit.solver.run import run
from febkit.solver.second_order import SecondOrder
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.values import Constant, Scaled
from helpers import scenes

END = 0.4

ANY = 0.1  # an error that no step here comes near: steps of second order of the given size


def _column() -> Problem:
    """A column compressed by a tenth in 1 s, neo-Hookean, seen at 0.4 s."""
    p = scenes.column(8, 0.6, 0.2, 0.5, top=-0.1)
    p.blocks[0].solid = NeoHookean(E=0.6, v=0.2)
    p.steps[0].newton.dtol = p.steps[0].newton.ptol = 1e-9
    return p


def _at_end(steps: int, accuracy: float) -> tuple[Any, int]:
    """Unknowns at END by ``steps`` equal steps (accuracy ANY: of second order), or by steps of their own size."""
    p = _column()
    s = p.steps[0]
    s.dt, s.count = END / steps, steps
    if 0 < accuracy < ANY:
        s.auto = AutoStep(must_points=(END,))
    result = run(p, options=Options(threads=1, accuracy=accuracy))
    assert result.converged, result.reason
    return result.state.d, result.totals.steps + result.totals.retries


@pytest.fixture(scope="module")
def exact() -> Any:
    return _at_end(640, ANY)[0]


def _error(d: Any, exact: Any) -> float:
    return max(float(np.linalg.norm((d - exact)[:, c]) / np.linalg.norm(exact[:, c])) for c in (2, 3))


def test_order_two_against_order_one(exact: Any) -> None:
    first = [_error(_at_end(n, 0.0)[0], exact) for n in (20, 40)]
    second = [_error(_at_end(n, ANY)[0], exact) for n in (10, 20, 40)]
    assert np.log2(first[0] / first[1]) == pytest.approx(1.0, abs=0.1)
    assert np.log2(second[1] / second[2]) == pytest.approx(2.0, abs=0.2)
    assert second[0] < first[1]  # as many solves, half the error and less


def test_the_error_asked_for(exact: Any) -> None:
    """The error at the end falls with the accuracy of a step (to the power 2/3 in theory), and is of its size."""
    tries = [_at_end(100, a) for a in (1e-3, 1e-4, 1e-5)]
    errors, steps = [_error(d, exact) for d, _ in tries], [n for _, n in tries]
    assert errors[0] > 2 * errors[1] > 4 * errors[2]
    assert all(e < 10 * a for e, a in zip(errors, (1e-3, 1e-4, 1e-5)))
    assert steps[1] < 3.2 * steps[0]  # order 2: ten times the accuracy at 2.2 times the steps
    plain = _error(_at_end(2 * steps[1], 0.0)[0], exact)
    assert errors[1] < 0.2 * plain


def test_what_an_old_factorisation_does_not_serve_is_not_tried_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    """Second stages over old factorisations fail: the step is taken again, with factorisations of its own."""
    failed, step = [], Newton.step

    def failing(self: Newton, how: Strategy) -> Counts:
        second = not np.array_equal(self.system.state.d, self.system.state.d_old)
        counts = step(self, how)
        if second and how.stale:
            failed.append(self.system.state.time)
            assert len(set(failed)) == len(failed), f"tried in vain twice at {failed[-1]}"
            raise NotConverged("the factorisation of an earlier step did not serve")
        return counts

    monkeypatch.setattr(Newton, "step", failing)
    p = _column()
    p.steps[0].newton = NewtonOptions(dtol=1e-4, ptol=1e-4)
    result = run(p, options=Options(threads=1, factor="reuse", accuracy=ANY))
    assert result.converged and failed, result.reason


def test_what_the_last_step_left_wrong_is_no_error_of_the_next() -> None:
    """Pressures put right as a step starts look like an error that no cut lessens; the step is taken all the same."""
    ends = {}
    for accuracy in (1e-6, 1e-5, 1e-4):
        p = _column()
        s = p.steps[0]
        top = next(c for c in s.conditions if isinstance(c, Prescribed))
        curved = replace(top, value=Scaled(Constant(-0.1), lambda t: 1.0 - math.exp(-t / 0.3)))
        s.conditions = [curved if c is top else c for c in s.conditions]
        s.dt, s.auto, s.duration = 0.002, AutoStep(must_points=(0.01, 0.02, 0.05, 0.1, 0.2, 0.3, END)), END
        result = run(p, options=Options(threads=1, accuracy=accuracy))
        assert result.converged, result.reason
        ends[accuracy] = result.state.d
    for a in (1e-4, 1e-5):
        off, size = (ends[a] - ends[1e-6])[:, 2], ends[1e-6][:, 2]
        assert np.linalg.norm(off) < a * np.linalg.norm(size)


def test_an_error_that_does_not_fall_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SecondOrder, "_error", lambda *_: 1.0)
    result = run(_column(), options=Options(threads=1, accuracy=1e-3))
    assert not result.converged and "error stays too large" in result.reason


def test_what_balance_is_left_does_not_add_up() -> None:
    """Where a residual of FEBio's min_residual is no balance, tight steps go below it: errors are of time alone."""
    ends = []
    for least in (1e-16, 1e-30):
        p = _column()
        s = p.steps[0]
        s.dt, s.auto, s.duration = END / 100, AutoStep(must_points=(END,)), END
        s.newton.min_residual = least
        result = run(p, options=Options(threads=1, accuracy=1e-5))
        assert result.totals.retries < 10  # what is left is no error of time that smaller steps were to mend
        ends.append(result.state.d)
    assert _error(ends[0], ends[1]) < 5e-5


def test_refused_where_it_has_no_meaning() -> None:
    p = _column()
    p.steps[0].analysis = "steady-state"
    with pytest.raises(ValueError, match="transient"):
        run(p, options=Options(threads=1, accuracy=1e-3))
