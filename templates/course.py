"""How a load goes on in time: one ramp, steps, or cycles; with the times at which results are written."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from febkit.model import InputError

SAMPLES = 20  # of a cycle: sin is drawn with these, 0.4 % low between them


@dataclass(frozen=True, slots=True)
class Course:
    """``points``: (time, share of the full load), linear in between; ``times``: must points of the time stepper."""

    points: list[tuple[float, float]]
    times: list[float]


def course(p: Mapping[str, Any]) -> Course:
    """The course that the template's parameters say, after ``rest`` seconds without load."""
    start, ramp, hold = float(p["rest"]), float(p["ramp"]), float(p["hold"])
    if p["course"] == "cyclic":
        points, times = _cycles(p, start, ramp)
    else:
        n = int(p["steps"]) if p["course"] == "steps" else 1
        points, times = _ramps(start, ramp, hold, n)
    before = [0.0, *(_held(0.0, start, start / 1000.0) if start else [])]
    times = before + times
    if p["times"]:
        times = [float(t) for t in p["times"]]
        if times[0] != 0.0:
            raise InputError(f"times must begin with 0, not {times[0]:g}")
    return Course([(0.0, 0.0), *points] if points[0][0] > 0.0 else points, times)


def _ramps(start: float, ramp: float, hold: float, n: int) -> tuple[list[tuple[float, float]], list[float]]:
    """n equal steps, each reached in ``ramp`` seconds and held for ``hold``."""
    points, times, t = [(start, 0.0)], [], start
    for k in range(1, n + 1):
        times += [t + ramp * j / 10.0 for j in range(1, 11)]
        t += ramp
        points.append((t, k / n))
        if hold > 0.0:
            times += _held(t, hold, ramp / 10.0)
            t += hold
            points.append((t, k / n))
    return points, [float(x) for x in times]


def _cycles(p: Mapping[str, Any], start: float, ramp: float) -> tuple[list[tuple[float, float]], list[float]]:
    """A ramp to the middle, then sines about it: load = 1 - swing/2 (1 + cos), between 1 - swing and 1."""
    swing, n = float(p["swing"]), int(p["cycles"])
    middle = 1.0 - swing / 2.0
    points, times = _ramps(start, ramp, 0.0, 1)
    points = [points[0], (points[1][0], middle)]
    t = start + ramp + np.arange(1, n * SAMPLES + 1) / SAMPLES / float(p["frequency"])
    load = middle + swing / 2.0 * np.sin(2.0 * np.pi * np.arange(1, n * SAMPLES + 1) / SAMPLES)
    return points + list(zip(t.tolist(), load.tolist(), strict=True)), times + [float(x) for x in t]


def _held(start: float, length: float, first: float) -> list[float]:
    """Times over a hold, five a decade: after ``first``, then ever further apart."""
    if first >= length:
        return [start + length]
    n = 1 + max(1, math.ceil(5.0 * math.log10(length / first)))
    return [*(start + np.geomspace(first, length, n)[:-1]).tolist(), start + length]
