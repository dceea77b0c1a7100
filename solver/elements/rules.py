"""Integration rules by name: points (g, dim) and weights (g,) on the reference shapes.

Line, quad and hex live on [-1, 1]^dim; triangle and tetrahedron on the unit simplex; penta is triangle
times line. Point order is FEBio's. Sources: Gauss-Legendre products; triangle rules of Radon (7 points)
and Hammer & Stroud (3, 4); tetrahedron rules of Keast, Comput. Methods Appl. Mech. Eng. 55 (1986) 339
(11 and 15 points), Hammer & Stroud (4), and FEBio's 8-point rule of degree 3.
"""

from __future__ import annotations

from functools import cache
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Rule = tuple[Floats, Floats]

# degree of the polynomials integrated exactly (in each direction for products)
DEGREE = {
    "line1": 1, "line2": 3, "line3": 5, "quad4": 3, "quad9": 5, "quad16": 7,
    "hex1": 1, "hex6": 3, "hex8": 3, "hex12": 3, "hex18": 3, "hex27": 5,
    "tri1": 1, "tri3": 2, "tri4": 3, "tri7": 5, "tet1": 1, "tet4": 2, "tet8": 3, "tet11": 4, "tet15": 5,
    "penta6": 2, "penta8": 3, "penta9": 1, "penta14": 3, "penta21": 5,
}


@cache
def rule(name: str) -> Rule:
    """Points and weights of a rule of :data:`DEGREE`."""
    kind, n = name.rstrip("0123456789"), int(name.lstrip("abcdefghijklmnopqrstuvwxyz"))
    points, weights = {"line": _line, "quad": _quad, "hex": _hex, "tri": _tri, "tet": _tet,
                       "penta": _penta}[kind](n)
    points.setflags(write=False)
    weights.setflags(write=False)
    return points, weights


def _gauss(n: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gauss's points and weights on [-1, 1]; closed forms where importing numpy's would cost more."""
    if n == 1:
        return np.zeros(1), np.full(1, 2.0)
    if n == 2:
        return np.array([-1.0, 1.0]) / np.sqrt(3.0), np.ones(2)
    if n == 3:
        return np.array([-1.0, 0.0, 1.0]) * np.sqrt(0.6), np.array([5.0, 8.0, 5.0]) / 9.0
    return np.polynomial.legendre.leggauss(n)


def _line(n: int) -> Rule:
    x, w = _gauss(n)
    return x[:, None], w


def _quad(n: int) -> Rule:
    m = round(n ** 0.5)
    x, w = _gauss(m)
    points = np.array([(a, b) for b in x for a in x])
    weights = np.outer(w, w).ravel()
    around = [0, 1, 3, 2] if m == 2 else list(range(n))
    return points[around], weights[around]


def _hex(n: int) -> Rule:
    if n == 6:
        points = np.array([(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1)], dtype=float)
        return points, np.full(6, 8 / 6)
    plane, height = {1: (1, 1), 8: (4, 2), 12: (4, 3), 18: (9, 2), 27: (9, 3)}[n]
    return _times(_quad(plane), _line(height))


def _penta(n: int) -> Rule:
    if n == 9:  # FEBio's, whose outer points are at 2/3 for sqrt(3/5)
        return _times(_tri(3), (np.array([[-2.0], [0.0], [2.0]]) / 3.0, _line(3)[1]))
    plane, height = {6: (3, 2), 8: (4, 2), 14: (7, 2), 21: (7, 3)}[n]
    return _times(_tri(plane), _line(height))


def _times(base: Rule, height: Rule) -> Rule:
    """Product of a plane rule and a line rule, the plane's points fastest."""
    points = np.vstack([np.column_stack([base[0], np.full(len(base[1]), z)]) for z in height[0][:, 0]])
    return points, np.concatenate([base[1] * w for w in height[1]])


def _tri(n: int) -> Rule:
    if n == 1:
        return np.full((1, 2), 1 / 3), np.array([0.5])
    if n == 3:
        return np.array([(1, 1), (4, 1), (1, 4)]) / 6, np.full(3, 1 / 6)
    if n == 4:
        points = np.array([(1 / 3, 1 / 3), (0.6, 0.2), (0.2, 0.2), (0.2, 0.6)])
        return points, np.array([-27, 25, 25, 25]) / 96
    s = np.sqrt(15.0)
    a, b = (6 - s) / 21, (6 + s) / 21
    c, d = 1 - 2 * a, 1 - 2 * b
    points = np.array([(1 / 3, 1 / 3), (c, a), (a, c), (a, a), (b, b), (b, d), (d, b)])
    return points, np.array([270.0, *[155 - s] * 3, *[155 + s] * 3]) / 2400


def _tet(n: int) -> Rule:
    quarter = np.full((1, 3), 0.25)
    if n == 1:
        return quarter, np.array([1 / 6])
    if n == 4:
        b = (5 - np.sqrt(5.0)) / 20
        return _vertex(b), np.full(4, 1 / 24)
    if n == 8:
        points = np.vstack([_vertex(b) for b in TET8_PLACES])
        return points, np.repeat([TET8_WEIGHT, 0.25 - TET8_WEIGHT], 4) / 6
    if n == 11:
        points = np.vstack([quarter, _vertex(1 / 14), _edge((1 - np.sqrt(5 / 14)) / 4)])
        return points, np.array([-74 / 5625, *[343 / 45000] * 4, *[56 / 2250] * 6])
    points = np.vstack([quarter, _vertex(1 / 3), _vertex(1 / 11), _edge(TET15_PLACE)])
    weights = [6544 / 36015, *[81 / 2240] * 4, *[161051 / 2304960] * 4, *[338 / 5145] * 6]
    return points, np.array(weights) / 6


# the one-parameter family of 8-point rules of degree 3, at FEBio's first place
TET8_PLACES = (0.3280546970, 0.10695227704963428)
TET8_WEIGHT = 0.13852796002922482
TET15_PLACE = 0.0665501535736643


def _vertex(b: float) -> Floats:
    """The four points with three barycentric coordinates b and one 1 - 3 b."""
    a = 1 - 3 * b
    return np.array([(b, b, b), (a, b, b), (b, a, b), (b, b, a)])


def _edge(b: float) -> Floats:
    """The six points with two barycentric coordinates b and two 1/2 - b."""
    a = 0.5 - b
    four = sorted(set(permutations((a, a, b, b))))
    return np.array([p[1:] for p in four])
