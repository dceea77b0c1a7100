"""What the next step brings, told from the ones before."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.forecast import Forecast, Past

A, B = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.1, -4.0])


def test_rates_that_change_by_a_trend_are_foretold_over_steps_of_any_length() -> None:
    past, end = Past(), 0.0
    for dt in (1.0, 0.7, 1.3):  # rate A + B t at the end of each step
        end += dt
        past.add(dt, dt * (A + B * end))
    mean, trend = past.led(1.1, 3)
    assert mean + trend == pytest.approx(1.1 * (A + B * (end + 1.1)))


def test_short_steps_count_together_and_without_any_nothing_is_foretold() -> None:
    past = Past()
    assert not np.any(past.led(1.0, 3))
    for dt, x in ((2.0, 2.0 * A), (0.1, 0.1 * A + 0.01), (0.4, 0.4 * A - 0.01)):
        past.add(dt, x)
    mean, trend = past.led(1.0, 3)
    assert mean == pytest.approx(A) and trend == pytest.approx(np.zeros(3), abs=1e-12)
    assert len(past.steps) == 3


@pytest.mark.parametrize("learns", [True, False])
def test_what_goes_with_the_run_is_learnt(learns: bool) -> None:
    """x = 3 times what the run grows by, which jumps about: its own mean and trend say nothing of it."""
    rng, n = np.random.default_rng(1), 40
    forecast, run, off = Forecast([np.arange(30), np.arange(30, 40)], n, learns), Past(), []
    for _ in range(8):
        dt, grown = rng.uniform(0.5, 2.0), rng.normal(size=n)
        mean, bend = run.led(dt, n)
        off.append(np.linalg.norm(forecast(dt, grown - mean, bend) - 3.0 * grown) / np.linalg.norm(3.0 * grown))
        forecast.learn(dt, 3.0 * grown)
        run.add(dt, grown)
    assert (off[-1] < 1e-8) == learns
