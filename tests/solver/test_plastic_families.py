"""Bond families by principal values beside the search along the whole tensors; secant tangents beside differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver.points import Points
from febkit.solver.solids import history, plastic_flow
from febkit.solver.solids.base import Floats
from febkit.solver.solids.registry import load
from febkit.solver.solids.secant import central_tangent, secant_tangent

CRITERIA: dict[str, dict[str, float]] = {
    "DC von Mises stress": {},
    "DC Deshpande-Fleck": {"beta": 0.3},
    "DC Drucker-Prager": {"b": 0.2},
}
FAILING = {
    "plastic_damage": lambda: load("cdf", "CDF Weibull")(Dmax=1.0, alpha=0.65, mu=7.95, ploc=0.0),
    "plastic_damage_criterion": lambda: load("criterion", "DC octahedral shear strain")(),
}


def plastic(kind: str, base: str, criterion: str, isochoric: int) -> Any:
    more = {k: make() for k, make in FAILING.items()} if kind == "reactive plastic damage" else {}
    return load("solid", kind)(
        elastic=load("solid", base)(E=100.0, v=0.3),
        yield_criterion=load("criterion", criterion)(**CRITERIA[criterion]),
        flow_curve=load("flow_curve", "PFC paper")(Y0=1.0, Ymax=5.0, w0=0.5, we=0.01, nf=4, r=0.8),
        isochoric=isochoric,
        **more,
    )


def walk(solid: Any, path: list[Floats]) -> list[tuple[Floats, Floats]]:
    """Stress (n, 6) and history after each state F (n, 3, 3) of a path."""
    old, out = history.initial(solid, len(path[0])), []
    for k, F in enumerate(path):
        pts = Points.at(F, old=old, new=old.copy(), t=k + 1.0, dt=1.0)
        s = np.zeros((pts.n, 6))
        solid.stress(pts, s, None)
        assert pts.new is not None
        old = pts.new
        out.append((s, old))
    return out


@pytest.mark.parametrize("isochoric", [0, 1])
@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize("base", ["neo-Hookean", "natural neo-Hookean"])
@pytest.mark.parametrize("kind", ["reactive plasticity", "reactive plastic damage"])
def test_families_by_principal_values_are_those_of_the_tensors(
    kind: str, base: str, criterion: str, isochoric: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Loaded beyond yield, back, and beyond it the other way, at any rotation."""
    d = np.random.default_rng(0).standard_normal((3, 3, 3)) * 0.01
    path = [np.eye(3) + a * d for a in (0.3, 1.0, 2.0, 4.0, 6.0, 5.0, 3.0, 0.0, -3.0, -6.0)]
    solid = plastic(kind, base, criterion, isochoric)
    found = walk(solid, path)
    monkeypatch.setattr(plastic_flow, "_BASES", {})
    sought = walk(solid, path)
    assert max(h[:, solid.offset + 10 : solid.offset + 11].max() for _, h in sought) > 0.0
    for (s, h), (s0, h0) in zip(found, sought, strict=True):
        # the parabola's root loses digits where its discriminant nearly vanishes
        np.testing.assert_allclose(s, s0, atol=1e-6 * np.abs(s0).max())
        np.testing.assert_allclose(h, h0, atol=1e-6 * np.abs(h0).max())


def test_secant_tangent_is_that_of_central_differences() -> None:
    solid = load("solid", "Holmes-Mow")(E=1.0, v=0.3, beta=0.6)
    pts = Points.at(np.eye(3) + 0.2 * np.random.default_rng(1).uniform(-1, 1, (3, 3, 3)))

    def stress(p: Points) -> Floats:
        s = np.zeros((p.n, 6))
        solid.stress(p, s, None)
        return s

    want = central_tangent(stress, pts)
    np.testing.assert_allclose(secant_tangent(stress, pts), want, atol=1e-6 * np.abs(want).max())
