"""Shape functions and their natural derivatives up to the third, of every solid element."""

from __future__ import annotations

from functools import cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from febkit.solver import elements

Floats = NDArray[np.float64]

# each reference shape in natural coordinates as the half spaces a . r <= b
_BRICK = (np.vstack([np.eye(3), -np.eye(3)]), np.ones(6))
_SIMPLEX = (np.vstack([np.ones((1, 3)), -np.eye(3)]), np.array([1.0, 0.0, 0.0, 0.0]))
_WEDGE = (np.array([[1.0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]), np.array([1.0, 0, 0, 1, 1]))
# pyramids of FEBio are collapsed bricks: their natural coordinates fill the brick
_REFERENCE = {"hex": _BRICK, "tet": _SIMPLEX, "pen": _WEDGE, "pyr": _BRICK}

# points where the gradient of a finite element solution is one order better (Barlow points):
# Zienkiewicz & Zhu, Int J Numer Methods Eng 33 (1992) 1331
_BARLOW = {
    "hex8": "hex1", "tet4": "tet1", "tet5": "tet1", "hex20": "hex8", "hex27": "hex8", "tet10": "tet4",
    "tet15": "tet4", "penta15": "penta6",
}


def outside(kind: str, r: Floats) -> Floats:
    """How far natural coordinates ``r`` (p, 3) lie outside the reference shape (p,); <= 0 inside."""
    a, b = _REFERENCE[kind[:3]]
    return np.asarray((r @ a.T - b).max(axis=1))


def shape(kind: str, r: Floats, order: int) -> Floats:
    """Derivative of order 0..3 of the shape functions: (p, n), (p, n, 3), (p, n, 3, 3), (p, n, 3, 3, 3)."""
    e = elements.get(kind)
    r = np.atleast_2d(r)
    out = np.empty((len(r), e.nodes) + (3,) * order)
    power = _powers(r, int(e.exponents.max()))
    for axes in product(range(3), repeat=order):
        if tuple(sorted(axes)) != axes:
            continue
        count = np.bincount(np.array(axes, dtype=int), minlength=3)
        lower = e.exponents - count
        factor = np.ones(len(lower))
        for d in range(3):
            for k in range(count[d]):
                factor = factor * (e.exponents[:, d] - k)
        lower = np.maximum(lower, 0)
        mono = power[0][:, lower[:, 0]] * power[1][:, lower[:, 1]] * power[2][:, lower[:, 2]]
        value = (mono * factor) @ e.coefficients
        same: Any
        for same in set(_permutations(axes)):
            out[(slice(None), slice(None), *same)] = value
    return out


def _powers(r: Floats, top: int) -> list[Floats]:
    """Per axis, the powers 0..top of a natural coordinate (p, top + 1)."""
    return [r[:, d, None] ** np.arange(top + 1) for d in range(3)]


def _permutations(axes: tuple[int, ...]) -> list[tuple[int, ...]]:
    from itertools import permutations

    return list(permutations(axes))


@cache
def barlow(kind: str) -> tuple[Floats, int]:
    """Superconvergent points (g, 3) of an element and the degree of the polynomial fitted to them."""
    from febkit.solver.elements.rules import rule

    e = elements.get(kind)
    points = rule(_BARLOW[kind])[0] if kind in _BARLOW else e.center[None]
    return np.asarray(points, dtype=float), e.order


@cache
def parents(kind: str) -> Floats:
    """Weights (n, corners): each node as the mean of the corners whose linear shape functions live there."""
    e = elements.get(kind)
    linear = {"hex": "hex8", "tet": "tet4", "pen": "penta6", "pyr": "pyra5"}[kind[:3]]
    live = np.abs(shape(linear, e.natural, 0)) > 1e-12
    return np.asarray(live / live.sum(axis=1, keepdims=True))
