"""Step sizes: the rules of FEBio's time stepper, one by one."""

from __future__ import annotations

from math import inf, nan, sqrt
from time import perf_counter
from typing import Any

import numpy as np
import pytest

from febkit.solver.problem import AutoStep, Saving, Step
from febkit.solver.saving import wanted
from febkit.solver.stepping import AutoSteps, FixedSteps, stepper


def auto(dt: float = 0.1, end: float = 1.0, **kw: Any) -> FixedSteps:
    return stepper(Step(dt=dt, duration=end, auto=AutoStep(**kw)), 0.0)


def walk(s: FixedSteps, iterations: int = 5, t: float = 0.0) -> list[float]:
    """Times of all steps where each takes as many iterations."""
    s.first(t)
    out = []
    while s.end - t > s.end * 1e-7:
        t = min(t + s.dt, s.end)
        out.append(t)
        s.accept(t, iterations)
        assert len(out) < 1000
    return out


def test_fixed_steps() -> None:
    s = stepper(Step(dt=0.25, count=4), 2.0)
    assert not isinstance(s, AutoSteps) and s.end == 3.0 and not s.retry()
    assert stepper(Step(dt=0.25, duration=0.6), 2.0).end == pytest.approx(2.6)


def test_grows_by_the_rule_where_iterations_are_few() -> None:
    s = auto(dtmax=0.5, optimal_iterations=11)
    s.first(0.0)
    assert s.dt == 0.1
    s.accept(0.1, 10)
    assert s.dt == pytest.approx(0.1 + (0.5 - 0.1) * (sqrt(11 / 10) - 1))


def test_growth_is_a_fifth_of_the_gap_at_most() -> None:
    s = auto(dtmax=0.3, optimal_iterations=11)
    s.first(0.0)
    s.accept(0.1, 1)
    assert s.dt == pytest.approx(0.1 + 0.2 * 0.2)


def test_shrinks_by_the_rule_and_not_below_dtmin() -> None:
    s = auto(dtmin=0.02, dtmax=0.5, optimal_iterations=4)
    s.first(0.0)
    s.accept(0.1, 16)
    assert s.dt == pytest.approx(0.1 - (0.1 - 0.02) * 0.5)
    for k in range(60):
        s.accept(0.1 + 0.001 * k, 400)
    assert s.dt >= 0.02


def test_the_end_is_met() -> None:
    times = walk(auto(dt=0.3, dtmax=0.3))
    assert times[-1] == 1.0 and times == sorted(times)


def test_must_points_are_met_exactly_and_flagged() -> None:
    must = (0.0, 0.13, 0.5, 1.0)
    s = auto(dt=0.1, dtmax=0.2, must_points=must)
    s.first(0.0)
    t, met = 0.0, []
    while s.end - t > 1e-7:
        t = min(t + s.dt, s.end)
        if s.at_must_point:
            met.append(t)
        s.accept(t, 5)
    np.testing.assert_allclose(met, must[1:], rtol=1e-12)


def test_size_before_a_must_point_is_taken_up_again_after_it() -> None:
    s = auto(dt=0.1, dtmax=0.1, must_points=(0.0, 0.11, 1.0))
    times = walk(s)
    assert times[1] == pytest.approx(0.11)
    assert times[2] == pytest.approx(0.21)


def test_dtmax_curve_limits() -> None:
    s = auto(dt=0.1, dtmax_curve=lambda t: 0.02 if t < 0.1 else 0.3)
    times = walk(s)
    assert np.diff([0.0, *times])[:5] == pytest.approx(0.02)
    assert np.diff(times).max() > 0.05


def test_retries_cut_in_equal_parts_until_they_are_used_up() -> None:
    s = auto(dt=0.12, dtmax=0.2, max_retries=5)
    s.first(0.0)
    sizes = []
    while s.retry():
        sizes.append(s.dt)
    np.testing.assert_allclose(sizes, 0.12 - 0.02 * np.arange(1, 6))
    s.accept(0.02, 3)
    assert s.retry(), "a converged step gives its retries back"


def test_aggressive_retries_halve() -> None:
    s = auto(dt=0.16, dtmax=0.2, aggressive=True, cutback=0.5, max_retries=3)
    s.first(0.0)
    sizes = [s.dt for _ in range(3) if s.retry()]
    np.testing.assert_allclose(sizes, [0.08, 0.04, 0.02])


def test_retries_may_go_below_dtmin() -> None:
    """As in FEBio: dtmin is for the size after a step that converged."""
    s = auto(dt=0.12, dtmax=0.2, dtmin=0.1, max_retries=5)
    s.first(0.0)
    while s.retry():
        pass
    assert s.dt == pytest.approx(0.02)
    s.accept(0.02, 3)
    assert s.dt == pytest.approx(0.1)


def test_a_step_cut_to_nothing_is_given_up() -> None:
    s = auto(dt=0.1, dtmax=0.2, aggressive=True, cutback=0.5, max_retries=10**6)
    s.first(0.0)
    cuts = 0
    while s.retry():
        cuts += 1
        assert cuts < 100
    assert s.vanishing and cuts == pytest.approx(36, abs=1)


def test_steps_that_shrink_for_ever_vanish() -> None:
    """Without dtmin a run of slow steps shrinks them geometrically; the run must be able to end."""
    s = auto(dt=0.1, dtmax=0.2, optimal_iterations=1)
    s.first(0.0)
    n = 0
    while not s.vanishing:
        s.accept(0.1, 25)
        n += 1
        assert n < 100


def test_a_retry_before_a_must_point_still_meets_it() -> None:
    s = auto(dt=0.1, dtmax=0.1, must_points=(0.0, 0.1, 1.0))
    s.first(0.0)
    assert s.at_must_point and s.retry() and not s.at_must_point
    t, met = 0.0, []
    while t < 0.3:
        t += s.dt
        met.append(t)
        s.accept(t, 5)
    assert any(abs(x - 0.1) < 1e-12 for x in met)


@pytest.mark.parametrize(("level", "event", "must", "saved"), [
    ("PLOT_MAJOR_ITRS", "major", False, True),
    ("PLOT_MUST_POINTS", "major", False, False),
    ("PLOT_MUST_POINTS", "major", True, True),
    ("PLOT_NEVER", "major", True, False),
    ("PLOT_FINAL", "major", True, False),
    ("PLOT_FINAL", "solved", False, True),
    ("PLOT_STEP_FINAL", "step", False, True),
])  # fmt: skip
def test_what_is_saved(level: str, event: str, must: bool, saved: bool) -> None:
    step = Step(auto=AutoStep(), saving=Saving(level))
    assert wanted(step, event, 3, must) is saved


def test_strides_and_ranges() -> None:
    step = Step(count=10, saving=Saving(stride=3))
    assert [k for k in range(1, 11) if wanted(step, "major", k, False)] == [3, 6, 9]
    step = Step(count=10, saving=Saving(range=(2, 4)))
    assert [k for k in range(1, 11) if wanted(step, "major", k, False)] == [2, 3, 4]
    step = Step(count=10, saving=Saving(range=(-2, -1)))
    assert [k for k in range(1, 11) if wanted(step, "major", k, False)] == [9, 10]


def test_must_points_may_stand_in_any_order_and_twice() -> None:
    sorted_once = walk(auto(dt=0.2, dtmax=0.2, must_points=(0.3, 0.7)))
    assert walk(auto(dt=0.2, dtmax=0.2, must_points=(0.7, 0.3, 0.7, 0.3, 0.3))) == sorted_once
    assert 0.3 in sorted_once and 0.7 in sorted_once


def test_must_points_repeat_by_their_last_time() -> None:
    """FEBio adds the last time, not the distance of the first from it."""
    times = walk(auto(dt=1.0, dtmax=1.0, end=2.0, must_points=(0.1, 0.5), repeat=True))
    np.testing.assert_allclose(times, [0.1, 0.5, 0.6, 1.0, 1.1, 1.5, 1.6, 2.0], rtol=1e-12)


@pytest.mark.parametrize("points", [(-1.0, -0.5), (-1.0, 0.0), (0.0, 1e-300)])
def test_must_points_that_never_come_to_an_end_are_refused(points: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="never come to an end"):
        auto(must_points=points, repeat=True)


def test_must_points_that_repeat_often_before_the_start_take_no_time() -> None:
    """2e10 periods lie before the start of this analysis step."""
    step = Step(dt=1e-10, duration=5e-10, auto=AutoStep(dtmax=1.0, must_points=(0.0, 5e-11), repeat=True))
    begun = perf_counter()
    s = stepper(step, 1e-1)
    s.first(1e-1)
    assert perf_counter() - begun < 0.1 and 0 < s.dt <= 5e-11 * (1 + 1e-5) and s.at_must_point


@pytest.mark.parametrize(("dt", "duration", "count"), [
    (nan, 1.0, -1), (0.1, nan, -1), (0.1, inf, -1), (inf, None, 5), (-0.1, None, 5), (0.0, 1.0, -1), (0.1, 0.0, -1),
    (0.1, None, -5), (0.1, None, 0),
])  # fmt: skip
def test_steps_that_lead_nowhere_are_refused(dt: float, duration: float | None, count: int) -> None:
    for rule in (None, AutoStep()):
        with pytest.raises(ValueError, match="no time steps"):
            stepper(Step(dt=dt, duration=duration, count=count, auto=rule), 0.0)


def test_an_error_controlled_run_meets_the_ends_of_the_files_steps() -> None:
    """However many they are: their times are not kept."""
    s = stepper(Step(dt=0.25, count=2_000_000_000), 3.0, accuracy=1e-3)
    t, met = 3.0, []
    s.first(t)
    for _ in range(4):
        t += s.dt
        met.append(t)
        s.accept(t, 5)
    assert met == [3.25, 3.5, 3.75, 4.0]
