"""Declared order against measured order, in space and in time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from febkit.solver import elements
from febkit.solver.options import Options
from febkit.solver.problem import Problem, Step
from febkit.solver.run import run
from febkit.solver.solids.isotropic_elastic import IsotropicElastic
from helpers import scenes

SMALL = 1e-7  # strains: what is left of geometric nonlinearity is below the errors measured


def exact(X: Any) -> Any:
    """u = grad phi with phi = cosh(a x) sin(b y) sin(c z) harmonic: div u = 0, so div sigma = 0 for any E, v."""
    b, c = 1.1, 1.3
    a = np.hypot(b, c)
    x, y, z = X[..., 0], X[..., 1], X[..., 2]
    Cx, Sx = np.cosh(a * x), np.sinh(a * x)
    parts = (
        a * Sx * np.sin(b * y) * np.sin(c * z),
        b * Cx * np.cos(b * y) * np.sin(c * z),
        c * Cx * np.sin(b * y) * np.cos(c * z),
    )
    return SMALL * np.stack(parts, axis=-1)


def error(kind: str, n: int) -> float:
    """Relative L2 error of u on the unit cube in n^3 cells, exact values on the boundary."""
    X, conn = scenes.box(kind, (n, n, n))
    nodes = scenes.skin(X)
    step = Step(dt=1.0, count=1, newton=scenes.tight(dtol=1e-9), conditions=scenes.prescribe(nodes, exact(X[nodes])))
    block = scenes.block(kind, conn, IsotropicElastic(1.0, 0.3))
    result = run(Problem(X, [block], [step]), options=Options(threads=1))
    assert result.converged, result.reason
    fine = elements.get(kind, "G27") if kind == "hex20" else elements.get(kind)
    x = np.einsum("ga,eai->egi", fine.N, X[conn])
    u = np.einsum("ga,eai->egi", fine.N, result.state.u[conn])
    J = np.linalg.det(np.einsum("gaj,eai->egij", fine.dN, X[conn]))
    w = J * fine.weights
    off = ((u - exact(x)) ** 2).sum(-1)
    # nodal points alone would flatter: add the error at the middle of the integration points
    return float(np.sqrt((w * off).sum() / (w * (exact(x) ** 2).sum(-1)).sum()))


@pytest.mark.parametrize(("kind", "order", "sizes"), [("hex8", 2, (3, 6)), ("tet4", 2, (3, 6)), ("hex20", 3, (2, 4)),
                                                      ("tet10", 3, (2, 4))])  # fmt: skip
def test_order_in_space(kind: str, order: int, sizes: tuple[int, int]) -> None:
    coarse, fine = (error(kind, n) for n in sizes)
    measured = np.log2(coarse / fine)
    assert order - 0.2 < measured < order + 1.0, (coarse, fine, measured)


def test_backward_euler_is_of_first_order() -> None:
    """Differences of the pressure in a column at one time, steps halved twice, fall by two."""

    def pressure(count: int) -> Any:
        p = scenes.column(6, 1.0, 0.2, 0.3, top=-1e-6)
        p.steps[0].dt, p.steps[0].count = 0.8 / count, count
        result = run(p, options=Options(threads=1))
        assert result.converged, result.reason
        return result.state.p

    a, b, c = (pressure(n) for n in (8, 16, 32))
    ratio = np.linalg.norm(b - a) / np.linalg.norm(c - b)
    assert 1.8 < ratio < 2.2, ratio
