"""Contact potential: its law, which facets act on each other, forces and tangents."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import contact
from febkit.solver.contact.surface import Facets
from febkit.solver.fields import DISPLACEMENT, Layout
from febkit.solver.kernels.potential import slope
from febkit.solver.problem import Problem, Step
from febkit.solver.state import State
from helpers import pair as scene

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


def make(first: Any, second: Any, **kw: Any) -> Any:
    kw = {"kc": 2.0, "p": 3.0, "R_in": 0.3, "R_out": 0.5} | kw
    return contact.load("contact potential")(Facets({"quad4": first}), Facets({"quad4": second}), **kw)


def squares(size: float, *corners: Any, **kw: Any) -> tuple[Any, State]:
    """Two squares of this size at these corners, and the contact between them."""
    X = np.vstack([size * SQUARE + c for c in corners])
    c = make(np.arange(4)[None], np.arange(4, 8)[None], **kw)
    state = State.at_rest(Problem(X, [], [Step()], fields=Layout([DISPLACEMENT])))
    c.begin(state, [])
    return c, state


def pushed(c: Any, state: State) -> Any:
    R = np.zeros_like(state.d)
    c.residual(state, R)
    return R


def test_the_law_is_smooth_and_ends() -> None:
    c, state = squares(0.01, [0.0, 0, 0], [0.0, 0, 0.4])
    law = c.law(state)
    h = 1e-7
    for r in (0.3, 0.5):  # value and slope alike on both sides
        below, at, above = (slope(law, r + k * h) for k in (-1, 0, 1))
        assert below == pytest.approx(at, abs=1e-3)
        assert (above - at) / h == pytest.approx((at - below) / h, rel=1e-4, abs=1e-3)
    assert slope(law, 0.1) - slope(law, 0.2) == pytest.approx(2.0 / 0.1**3 - 2.0 / 0.2**3)
    assert slope(law, 0.6) == 0.0


@pytest.mark.parametrize("distance", [0.2, 0.4, 0.6])
def test_small_facets_push_each_other_apart(distance: float) -> None:
    c, state = squares(0.01, [0.0, 0, 0], [0.0, 0, distance])
    R = pushed(c, state)
    f = slope(c.law(state), distance) * 1e-4**2
    assert R[4:, 2].sum() == pytest.approx(f, rel=0.02)
    assert R[:4, 2].sum() == pytest.approx(-f, rel=0.02)
    assert c.values(c.sides[1], "pressure", state) == pytest.approx(f / 1e-4, rel=0.05)


def test_which_facets_act_on_each_other() -> None:
    def pairs(**kw: Any) -> int:
        return len(squares(0.1, [0.0, 0, 0], [0.3, 0, 0.1], **kw)[0].first)

    assert pairs() == 1
    assert pairs(R_out=0.2, R_in=0.1) == 0
    assert pairs(w_tol=0.5) == 0  # no line between them is that steep
    assert pairs(w_tol=0.3) == 1
    assert pairs(R0_min=0.05) == 1  # by squares of distances
    assert pairs(R0_min=0.2) == 0
    p = scene.Pair()
    itself = make(p.upper, p.upper, R_out=0.55, R_in=0.2)
    state = scene.started(p, itself)
    scene.forces(itself, state, np.zeros_like(p.X))
    shared = [len(np.intersect1d(p.upper[a], p.upper[b])) for a, b in zip(itself.first, itself.second, strict=True)]
    assert len(shared) > 0
    assert max(shared) == 0


@pytest.mark.parametrize("rules", [{}, {"quad4": "G16"}])
def test_tangent_is_the_derivative_where_areas_stay(rules: dict[str, str]) -> None:
    p = scene.Pair(gap=0.25, skew=0.1)
    c = make(p.upper, p.lower)
    c.primary.rules = c.secondary.rules = rules
    state = scene.started(p, c)
    d = np.zeros_like(p.X)
    d[np.unique(p.top)] = [0.02, 0.01, -0.03]
    R = scene.forces(c, state, d)
    assert np.abs(R).max() > 1e-2
    assert np.abs(R.sum(axis=0)).max() < 1e-12
    assert len(c.sides[0].points) == (16 if rules else 4) * len(p.upper)
    K, h = scene.stiffness(c, state), 1e-6
    assert np.allclose(K, K.T, atol=1e-12)
    for axis in range(3):
        v = np.zeros_like(p.X)
        v[np.unique(p.top), axis] = 1.0
        D = -(scene.forces(c, state, d + h * v) - scene.forces(c, state, d - h * v)) / (2 * h)
        assert K @ v.ravel() == pytest.approx(D.ravel(), abs=1e-6 * np.abs(D).max())
