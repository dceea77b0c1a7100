"""What the next step brings, told from the ones before."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.forecast import Forecast, Guess, Past
from febkit.solver.vectors import norm

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


def test_a_guess_follows_a_steady_growth_and_its_trend() -> None:
    """Two fields that grow as t + a t^2, ten orders of magnitude apart, in steps of a length."""
    fields = [np.arange(20), np.arange(20, 30)]
    size = np.where(np.arange(30) < 20, 1e-6, 1e4) * np.linspace(1.0, 2.0, 30)
    given, guess, off = np.zeros(30), Guess(30, fields), []
    for k in range(8):
        x = size * (0.1 + 0.02 * (2 * k + 1))
        told = guess(0.1, given)
        off.append(np.inf if told is None else max(norm(told[f] - x[f]) / norm(x[f]) for f in fields))
        guess.learn(0.1, x)
    assert off[:2] == [np.inf, np.inf] and off[-1] < 1e-3
    saved = guess.snapshot()
    twice = [guess(0.1, given)]
    guess.learn(0.1, -size)
    assert guess(0.1, given) is None  # it was wrong
    guess.restore(saved)
    twice.append(guess(0.1, given))
    assert twice[0] is not None and twice[1] is not None and (twice[0] == twice[1]).all()


def test_no_guess_where_what_is_prescribed_goes_otherwise() -> None:
    guess, given = Guess(4, [np.arange(4)]), np.array([0.0, 0.0, 0.0, 0.2])
    for _ in range(4):
        guess(0.1, given)
        guess.learn(0.1, np.ones(4))
    assert guess(0.1, given) is not None
    guess.learn(0.1, np.ones(4))
    assert guess(0.2, 2.0 * given) is not None  # as fast
    guess.learn(0.2, 2.0 * np.ones(4))
    assert guess(0.1, np.zeros(4)) is None  # held


def test_no_guess_after_a_step_that_was_cut() -> None:
    guess, given = Guess(4, [np.arange(4)]), np.zeros(4)
    taken = []
    for k in range(10):
        taken.append(guess(0.1, given) is not None)
        if k == 5:
            guess.doubt()
        guess.learn(0.1, np.ones(4))
    assert taken == [False, False, True, True, True, True, False, False, True, True]
