"""Fiber directions and local axes: made once for the places of a few points, anew where time or place is another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from febkit.solver.points import FEW, Points
from febkit.solver.solids import axes
from febkit.solver.solids.fiber import directions, part
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.values import Constant, Scaled

GENERATORS: dict[str, Callable[[], Any]] = {
    "vector": lambda: axes.fixed_vector([1.0, 2.0, 2.0]),
    "element data": lambda: axes.fixed_vector(np.eye(3)),
    "spherical": lambda: axes.SphericalVector(vector=(1.0, 1.0, 0.0)),
    "cylindrical": lambda: axes.CylindricalVector(vector=(1.0, 1.0, 0.0)),
    "angles": lambda: axes.AngleVector(30.0, 60.0),
    "math": lambda: axes.MathVector(Constant(1.0), Constant(2.0), Constant(3.0)),
    "angles that vary": lambda: axes.AngleVector(Scaled(Constant(30.0), lambda t: t), 60.0),
    "math that varies": lambda: axes.MathVector(Constant(1.0), Constant(2.0), Scaled(Constant(3.0), lambda t: t)),
}


def points(n: int = 3, t: float = 1.0) -> Points:
    X = np.random.default_rng(1).normal(size=(n, 3))
    return Points(np.tile(np.eye(3), (n, 1, 1)), np.ones(n), X, np.arange(n) % 3, t)


@pytest.mark.parametrize("name", GENERATORS)
def test_directions_are_those_of_the_place_and_the_time(name: str) -> None:
    """However often they are asked for, in whichever order."""
    fiber, pts = GENERATORS[name](), points()
    Q = np.array([[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]])
    for t in (1.0, 2.0, 1.0):
        for axes_ in (None, Q, None, Q):
            pts.t, pts.Q = t, axes_
            found = np.broadcast_to(directions(fiber, pts), (3, 3))
            new = np.broadcast_to(directions(GENERATORS[name](), replace(points(t=t), Q=axes_)), (3, 3))
            np.testing.assert_array_equal(found, new)
            some = part(pts, slice(1, 3))
            np.testing.assert_array_equal(np.broadcast_to(directions(fiber, some), (2, 3)), found[1:])
    assert fiber.steady != ("var" in name)


def test_few_points_remember() -> None:
    calls = []
    fiber = axes.SphericalVector()

    def make(pts: Points) -> np.ndarray:
        return pts.once((fiber,), lambda: (calls.append(pts.n), fiber(pts))[1])

    for n in (3, FEW + 1):
        pts = points(n)
        assert make(pts) is not None and make(replace(pts, F=2 * pts.F)).shape == (n, 3)
    assert calls == [3, FEW + 1, FEW + 1]


def test_own_axes_are_turned_by_those_above() -> None:
    law = NeoHookean(E=1.0, v=0.3, mat_axis=axes.vector_axes((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    pts = points()
    own = law.inner(pts)
    assert law.inner(replace(pts, F=2 * pts.F)).Q is own.Q
    Q = np.array([[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]])
    np.testing.assert_array_equal(law.inner(replace(pts, Q=Q)).Q, Q @ own.Q)
