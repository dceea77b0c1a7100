"""Meshes of every solid element and boundary value problems with known answers, as the solver takes them."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import numpy as np

from febkit.solver import elements
from febkit.solver.fields import DISPLACEMENT, PRESSURE, Layout
from febkit.solver.permeabilities.const_iso import ConstIso
from febkit.solver.physics import default
from febkit.solver.physics.biphasic import Biphasic
from febkit.solver.problem import TRANSIENT, Block, Fixed, NewtonOptions, Prescribed, Problem, Step
from febkit.solver.solids.isotropic_elastic import IsotropicElastic
from febkit.solver.values import Constant, Expression, Map, Scaled

# columns of solids and of biphasic models
UX, UY, UZ = Layout([DISPLACEMENT]).displacement.tolist()
P = Layout([DISPLACEMENT, PRESSURE]).column("p")

# a linear problem takes one iteration, the next only proves it
TIGHT: dict[str, Any] = dict(
    method="full Newton", updates=0, dtol=1e-13, etol=0.0, ptol=1e-13, line_tolerance=0.0, max_reforms=40,
    min_residual=0.0, diverge_reform=False,
)


def tight(**other: Any) -> NewtonOptions:
    """Full Newton to round-off: dtol on the norm of increments only."""
    return NewtonOptions(**{**TIGHT, **other})


def grid(n: tuple[int, int, int], size: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> tuple[Any, Any]:
    """Nodes (node, 3) and hexahedra (m, 8) of a box."""
    axes = [np.linspace(0.0, s, k + 1) for k, s in zip(n, size)]
    X = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    k = np.arange(len(X)).reshape(*(m + 1 for m in n))
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = [k[a : a + n[0], b : b + n[1], c : c + n[2]] for a, b, c in corners]
    return X, np.stack(cells, axis=-1).reshape(-1, 8)


def distorted(X: Any, amount: float, inside: Any) -> Any:
    """The nodes ``inside`` moved at random by up to ``amount``."""
    shift = np.random.default_rng(7).uniform(-amount, amount, X.shape)
    return X + shift * inside[:, None]


def _split(linear: str, X: Any, hexes: Any) -> tuple[Any, Any]:
    """Hexahedra cut into elements of another linear type."""
    if linear == "hex8":
        return X, hexes
    if linear == "penta6":
        return X, np.vstack([hexes[:, [0, 1, 2, 4, 5, 6]], hexes[:, [0, 2, 3, 4, 6, 7]]])
    if linear == "pyra5":
        center = len(X) + np.arange(len(hexes))
        faces = [list(f)[::-1] for _, f in elements.shape("hex8").facets]
        X = np.vstack([X, X[hexes].mean(axis=1)])
        return X, np.vstack([np.column_stack([hexes[:, f], center]) for f in faces])
    corner = {c: i for i, c in enumerate([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1),
                                          (0, 1, 1)])}  # fmt: skip
    tets = []
    for order in permutations(range(3)):  # Kuhn: walk from corner 0 to corner 6 along the axes
        at, path = [0, 0, 0], [0]
        for axis in order:
            at[axis] = 1
            path.append(corner[at[0], at[1], at[2]])
        even = np.linalg.det(np.eye(3)[list(order)]) > 0
        tets.append(hexes[:, path if even else [path[0], path[2], path[1], path[3]]])
    return X, np.vstack(tets)


def box(kind: str, n: tuple[int, int, int], distort: float = 0.0) -> tuple[Any, Any]:
    """The unit cube meshed by elements of ``kind``, straight edges between distorted corners."""
    X, hexes = grid(n)
    inside = ((X > 1e-9) & (X < 1 - 1e-9)).all(axis=1)
    X = distorted(X, distort / max(n), inside)
    linear = {"hex": "hex8", "tet": "tet4", "pen": "penta6", "pyr": "pyra5"}[kind[:3]]
    X, conn = _split(linear, X, hexes)
    if kind == linear:
        return X, conn
    N = elements.get(linear).shape(elements.get(kind).natural)
    x = np.einsum("an,eni->eai", N, X[conn]).reshape(-1, 3)
    _, first, same = np.unique(np.round(x, 9), axis=0, return_index=True, return_inverse=True)
    return x[first], same.reshape(len(conn), -1)


def skin(X: Any) -> Any:
    """Nodes on the faces of the unit cube."""
    return np.flatnonzero(((X < 1e-9) | (X > 1 - 1e-9)).any(axis=1))


def block(kind: str, conn: Any, solid: Any, physics: Any = None, **kw: Any) -> Block:
    return Block("part", kind, conn, np.arange(1, len(conn) + 1), solid, physics or default(), **kw)


def prescribe(nodes: Any, values: Any, first: int = UX) -> list[Prescribed]:
    """Columns from ``first`` on prescribed to ``values`` (node, k)."""
    return [Prescribed(first + k, nodes, _Given(values[:, k])) for k in range(values.shape[1])]


class _Given(Map):
    """One number per node of the set, by its place in the set."""


def ramp(value: float, until: float) -> Scaled:
    """From 0 at time 0 to ``value``, then constant."""
    return Scaled(Constant(value), lambda t: min(t / until, 1.0))


def column(
    n: int, E: float, v: float, k: float, h: float = 1.0, top: float | None = None, grading: float = 1.0
) -> Problem:
    """Confined column of height h, drained on top; ``top`` prescribes the top displacement by a ramp of 1 s.

    Without ``top`` nothing acts on it: the caller adds a load. The step is left to the caller.
    """
    X, conn = grid((1, 1, n), (0.1 * h, 0.1 * h, h))
    X[:, 2] = h * (1 - (1 - X[:, 2] / h) ** grading)
    solid = IsotropicElastic(E, v)
    conditions: list[Any] = [Fixed(c, np.arange(len(X))) for c in range(UX, UZ)]
    conditions += [Fixed(UZ, np.flatnonzero(X[:, 2] < 1e-9)), Fixed(P, np.flatnonzero(X[:, 2] > h - 1e-9))]
    if top is not None:
        conditions.append(Prescribed(UZ, np.flatnonzero(X[:, 2] > h - 1e-9), ramp(top, 1.0)))
    step = Step(analysis=TRANSIENT, newton=tight(dtol=1e-7, ptol=1e-7, min_residual=1e-30), conditions=conditions)
    return Problem(X, [block("hex8", conn, solid, Biphasic(ConstIso(k)))], [step])


def top_quads(n: int) -> Any:
    """The quadrilateral on top of :func:`column`, outward."""
    k = np.arange(4 * (n + 1)).reshape(2, 2, n + 1)
    return np.array([[k[0, 0, n], k[1, 0, n], k[1, 1, n], k[0, 1, n]]])


def field(f: Any) -> Expression:
    """A value that is a function of place alone."""
    return Expression(lambda X, Y, Z, t: f(X, Y, Z), steady=True)
