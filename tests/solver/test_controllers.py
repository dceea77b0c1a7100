"""Load curves: values worked out by hand, and laws each interpolation must satisfy."""

from __future__ import annotations

import math
from math import floor
from time import perf_counter

import numpy as np
import pytest

from febkit.solver.controllers import EXTENSIONS, INTERPOLATIONS, Interval, LoadCurve

P = [(0, 0), (1, 2), (3, -1), (4, 0.5), (5, 3), (7, 1)]
THROUGH = [i for i in INTERPOLATIONS if i not in ("step", "control points", "approximation")]


def test_linear() -> None:
    f = LoadCurve(P, "LINEAR")
    assert [f(t) for t in (0, 0.5, 1, 2, 7)] == [0, 1, 2, 0.5, 1]


def test_step_takes_the_next_point() -> None:
    f = LoadCurve(P, "STEP")
    assert [f(t) for t in (0, 0.5, 1, 2, 3, 6.9, 7)] == [0, 2, -1, -1, 0.5, 1, 1]


def test_a_repeated_time_is_a_jump() -> None:
    f = LoadCurve([(0, 0), (1, 1), (1, 5), (2, 5)])
    assert f(1 - 1e-12) == pytest.approx(1) and f(1) == 5


def test_smooth_step() -> None:
    f = LoadCurve([(0, 0), (2, 4)], "smooth-step")
    assert f(1) == 2 and f(0.5) == pytest.approx(4 * 0.25**3 * (10 - 15 / 4 + 6 / 16))


def test_smooth_of_three_points_is_their_parabola() -> None:
    f = LoadCurve([(0, 1), (1, 0), (3, 4)], "smooth")
    q = np.polyfit([0, 1, 3], [1, 0, 4], 2)
    for t in (0.3, 1.7, 2.9):
        assert f(t) == pytest.approx(np.polyval(q, t))


def test_smooth_blends_two_parabolas() -> None:
    f, (x, y) = LoadCurve(P, "smooth"), np.transpose(P)
    left, right = np.polyfit(x[1:4], y[1:4], 2), np.polyfit(x[2:5], y[2:5], 2)
    w = 0.4
    assert f(3.4) == pytest.approx((1 - w) * np.polyval(left, 3.4) + w * np.polyval(right, 3.4))
    assert f(0.5) == pytest.approx(np.polyval(np.polyfit(x[:3], y[:3], 2), 0.5))
    assert f(6.0) == pytest.approx(np.polyval(np.polyfit(x[3:], y[3:], 2), 6.0))


@pytest.mark.parametrize("interpolate", THROUGH)
def test_curves_through_their_points(interpolate: str) -> None:
    f = LoadCurve(P, interpolate)
    for t, y in P:
        assert f(t) == pytest.approx(y, abs=1e-12)
        if 0 < t < 7:
            assert f(t + 1e-9) == pytest.approx(y, abs=1e-6)


@pytest.mark.parametrize("interpolate", ["cubic spline", "approximation"])
def test_splines_hold_cubics(interpolate: str) -> None:
    x = np.linspace(0, 2, 9)
    f = LoadCurve(np.column_stack([x, x**3 - x]), interpolate)
    for t in (0.11, 0.97, 1.83):
        assert f(t) == pytest.approx(t**3 - t, abs=1e-12)


def test_control_points_draw_a_bezier_curve_where_there_are_four() -> None:
    y = [0.0, 3.0, -1.0, 2.0]
    f = LoadCurve(list(zip([0, 1, 2, 3], y, strict=True)), "CONTROL POINTS")
    w = 0.35
    exact = sum(math.comb(3, i) * w**i * (1 - w) ** (3 - i) * y[i] for i in range(4))
    assert f(3 * w) == pytest.approx(exact)


def test_extensions() -> None:
    p = [(1, 1), (2, 3), (3, 2)]
    assert LoadCurve(p)(0) == 1 and LoadCurve(p)(9) == 2
    f = LoadCurve(p, "linear", "EXTRAPOLATE")
    assert f(0) == -1 and f(5) == 0
    f = LoadCurve(p, "linear", "REPEAT")
    assert f(3.5) == 2 and f(5.5) == 2 and f(0.5) == 2.5 and f(5) == 2
    f = LoadCurve(p, "linear", "REPEAT OFFSET")
    assert f(3.5) == 3 and f(5.5) == 4 and f(0.5) == 1.5
    f = LoadCurve(p, "step", "extrapolate")
    assert f(0) == 1 and f(9) == 2


def test_smooth_extrapolates_along_its_end() -> None:
    f = LoadCurve([(0, 0), (1, 1), (2, 4)], "smooth", "extrapolate")  # t^2
    slope = (4 - 1.998**2) / 0.002
    assert f(3) == pytest.approx(4 + slope, rel=1e-9)


def test_empty_and_single() -> None:
    assert LoadCurve([])(1.0) == 0.0 and LoadCurve([(1, 4)])(9.0) == 4.0


@pytest.mark.parametrize("extend", ["REPEAT", "REPEAT OFFSET"])
@pytest.mark.parametrize("ends", [(0, 1e-9), (1e6, np.nextafter(1e6, 2e6)), (0, 5e-324)])
def test_periods_far_below_the_time_take_no_time(ends: tuple[float, float], extend: str) -> None:
    """FEBio takes off one period after the other: here more than 1e8 of them, or for ever."""
    f, start = LoadCurve([(ends[0], 0), (ends[1], 1)], "linear", extend), perf_counter()
    for t in (0.2, 1.0, -3.7, 1e17):
        value = f(t)
        assert extend == "REPEAT OFFSET" or 0 <= value <= 1
    assert perf_counter() - start < 0.1


@pytest.mark.parametrize("t", [1000.3, 4321.75, -1000.3, -4321.75])
def test_remainders_agree_with_periods_taken_off_one_by_one(t: float) -> None:
    f, g = (LoadCurve([(0, 1), (0.75, 3), (1, 2)], "linear", e) for e in ("REPEAT", "REPEAT OFFSET"))
    assert f(t) == pytest.approx(f(t - floor(t)), rel=1e-9)
    assert g(t) == pytest.approx(f(t) + floor(t), rel=1e-9)


def test_ends_of_periods_belong_to_the_curve_before_them() -> None:
    f = LoadCurve([(0, 0), (1, 1)], "linear", "REPEAT")
    assert f(3) == 1 and f(-2) == 0, "below a thousand periods"
    assert f(30000) == 1 and f(-30000) == 0, "beyond"
    assert f(29999.75) == pytest.approx(0.75) and f(-29999.75) == pytest.approx(0.25)


def test_bad_input_is_named() -> None:
    with pytest.raises(ValueError, match="wiggly"):
        LoadCurve(P, "wiggly")
    with pytest.raises(ValueError, match="extension"):
        LoadCurve(P, "linear", "wiggly")
    with pytest.raises(ValueError, match="go back"):
        LoadCurve([(1, 0), (0, 0)])
    with pytest.raises(ValueError, match="finite"):
        LoadCurve([(0, 0), (1, math.nan)])
    for ends in ((1.0, 1.0), (2.0, 1.0), (0.0, math.inf), (math.nan, 1.0)):
        with pytest.raises(ValueError, match="after its start"):
            Interval(lambda t: t, ends, "repeat", "repeat")
    assert LoadCurve(P, "2", "3").interpolate == INTERPOLATIONS[2] and len(EXTENSIONS) == 4


def test_interval() -> None:
    f = Interval(lambda t: t * t, (1.0, 3.0), "zero", "repeat")
    assert f(0.5) == 0 and f(2) == 4 and f(4.5) == pytest.approx(2.5**2)
