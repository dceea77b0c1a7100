"""What an element is: nodes in natural coordinates, a polynomial span, an integration rule, facets.

Shape functions are not typed in: they are the basis of the span that is 1 at one node and 0 at the
others, N_a = sum_m C[m, a] phi_m(r) with C the inverse of phi_m(r_a). Derivatives are exact.
"""

from __future__ import annotations

import re
from dataclasses import field, replace

import numpy as np
from numpy.typing import NDArray

from ..record import record, variable_record
from .rules import rule

Floats = NDArray[np.float64]
_TERM = re.compile(r"([+-]?)((?:[rst]\d?)+|1)")
_FACTOR = re.compile(r"([rst])(\d?)")


def _span(text: str, dim: int) -> tuple[NDArray[np.int64], Floats]:
    """Exponents (k, dim) and weights (m, k) of the m functions in ``text``, such as "1 r s rs r2s+rs2"."""
    functions: list[dict[tuple[int, ...], float]] = []
    for word in text.split():
        terms: dict[tuple[int, ...], float] = {}
        for sign, monomial in _TERM.findall(word):
            powers = dict.fromkeys("rst"[:dim], 0)
            for letter, power in _FACTOR.findall(monomial):
                powers[letter] += int(power or 1)
            terms[tuple(powers.values())] = -1.0 if sign == "-" else 1.0
        functions.append(terms)
    exponents = sorted({e for f in functions for e in f})
    weights = np.array([[f.get(e, 0.0) for e in exponents] for f in functions])
    return np.array(exponents, dtype=np.int64), weights


def _monomials(r: Floats, exponents: NDArray[np.int64]) -> Floats:
    """Values (p, k) of the monomials at ``r`` (p, dim)."""
    powers: Floats = np.asarray(r, dtype=float)[:, None, :] ** exponents[None]
    return np.asarray(powers.prod(axis=2))


@record
class Element:
    """An element with one integration rule; local node order is FEBio's.

    ``N`` (g, n) and ``dN`` (g, n, dim) are values and natural derivatives at the rule's ``points``
    (g, dim) with ``weights`` (g,). ``extrapolation`` (n, g) takes point values to the nodes. Each facet
    is (type, local nodes), its normal outward; each edge its local nodes, both ends first.
    """

    name: str
    dim: int
    order: int  # degree of the complete polynomials the span holds
    corners: int
    rule: str
    rules: tuple[str, ...]  # the rules this element may be had with, the default first
    natural: Floats  # (n, dim) natural coordinates of the nodes
    points: Floats
    weights: Floats
    N: Floats
    dN: Floats
    facets: tuple[tuple[str, tuple[int, ...]], ...]
    edges: tuple[tuple[int, ...], ...]
    center: Floats  # (dim,)
    extrapolation: Floats
    exponents: NDArray[np.int64] = field(repr=False)
    coefficients: Floats = field(repr=False)  # (k, n)

    @property
    def nodes(self) -> int:
        return len(self.natural)

    @property
    def npoints(self) -> int:
        return len(self.weights)

    def shape(self, r: Floats) -> Floats:
        """Shape functions (p, n) at natural coordinates ``r`` (p, dim)."""
        return _monomials(np.atleast_2d(r), self.exponents) @ self.coefficients

    def gradient(self, r: Floats) -> Floats:
        """Natural derivatives (p, n, dim) of the shape functions at ``r`` (p, dim)."""
        r = np.atleast_2d(r)
        out = np.empty((len(r), self.nodes, self.dim))
        for i in range(self.dim):
            lower = self.exponents.copy()
            lower[:, i] = np.maximum(lower[:, i] - 1, 0)
            out[:, :, i] = (_monomials(r, lower) * self.exponents[:, i]) @ self.coefficients
        return out


@variable_record
class Shape:
    """The table an element's file holds; :meth:`element` makes an :class:`Element` of it."""

    name: str
    dim: int
    order: int
    corners: int
    nodes: tuple[tuple[float, ...], ...]
    span: str
    rules: dict[str, str]  # FEBio's name of the rule -> name in rules.py, the default first
    center: tuple[float, ...]
    facets: tuple[tuple[str, tuple[int, ...]], ...] = ()
    linear_fit: bool = False  # point values go to the nodes by a fit linear in r, s, t
    fit_points: dict[str, tuple[int, ...]] = field(default_factory=dict)  # rule -> the points fitted

    def element(self, name: str | None = None) -> Element:
        name = name or next(iter(self.rules))
        if name not in self.rules:
            raise KeyError(f"{self.name} has no rule {name}; it has {', '.join(self.rules)}")
        natural = np.array(self.nodes, dtype=float)
        exponents, weights = _span(self.span, self.dim)
        values = _monomials(natural, exponents) @ weights.T  # phi_m(r_a) as (a, m)
        inverse = np.linalg.inv(values)
        exact = np.round(inverse * 576.0) / 576.0  # the coefficients of all our elements are such fractions
        if np.abs(inverse - exact).max() > 1e-9:
            raise AssertionError(f"{self.name}: coefficients are not the fractions expected")
        points, w = (a.copy() for a in rule(self.rules[name]))  # own arrays: kernels want them writable
        bare = Element(
            name=self.name, dim=self.dim, order=self.order, corners=self.corners, rule=name,
            rules=tuple(self.rules), natural=natural, points=points, weights=w, N=np.empty(0),
            dN=np.empty(0), facets=self.facets, edges=self._edges(), center=np.array(self.center),
            extrapolation=np.empty(0), exponents=exponents, coefficients=weights.T @ exact,
        )
        N = bare.shape(points)
        extrapolation = self._extrapolation(name, natural, points, N)
        return replace(bare, N=N, dN=bare.gradient(points), extrapolation=extrapolation)

    def _extrapolation(self, name: str, natural: Floats, points: Floats, N: Floats) -> Floats:
        """Least squares from the points to the nodes, in the span itself or linear in r, s, t."""
        if self.linear_fit:
            one = [np.column_stack([np.ones(len(x)), x]) for x in (points, natural)]
            return np.asarray(one[1] @ np.linalg.pinv(one[0]))
        pick = list(self.fit_points.get(name, range(len(points))))
        out = np.zeros((len(natural), len(points)))
        out[:, pick] = np.linalg.pinv(N[pick])
        return out

    def _edges(self) -> tuple[tuple[int, ...], ...]:
        """Edges in the order the facets meet them: both ends, then the nodes between."""
        found: dict[tuple[int, ...], tuple[int, ...]] = {}
        if self.dim == 1:
            return (tuple(range(len(self.nodes))),)
        loops = self.facets or ((self.name, tuple(range(len(self.nodes)))),)
        for kind, loop in loops:
            m = 4 if kind.startswith("quad") else 3
            between = len(loop) // m - 1
            for i in range(m):
                ends = loop[i], loop[(i + 1) % m]
                middle = loop[m + between * i : m + between * (i + 1)]
                found.setdefault(tuple(sorted(ends)), (*ends, *middle))
        return tuple(found.values())
