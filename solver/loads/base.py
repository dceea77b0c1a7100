"""What a load on facets is: external forces at their nodes (:mod:`..action`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from .. import elements
from ..action import Action, Floats, Ints, Matrices
from ..elements import nodal
from ..elements.base import Element
from ..fields import DISPLACEMENT
from ..kernels.surface import add_vectors
from ..record import record, variable_record
from ..values import Value, as_value

if TYPE_CHECKING:
    from ..state import State

Number = Value | float
Vector = Sequence[Number]  # three numbers, each a value


@record
class Patch:
    """Facets of one type: nodes, the facet element, and where its points lie in the reference.

    ``items`` (f g,) are rows of the surface that a map of values is given on.
    """

    conn: Ints
    element: Element
    points: Floats  # (f g, 3)
    items: Ints

    @classmethod
    def of(
        cls, kind: str, conn: Ints, X: Floats, items: Ints | None = None, rule: str | None = None
    ) -> Patch:
        """Facets of type ``kind`` ("quad4") with nodes ``conn`` at reference positions ``X`` (node, 3)."""
        e = nodal.element(kind) if rule == nodal.RULE else elements.get(kind, rule)
        conn = np.ascontiguousarray(conn, dtype=np.int64)
        points = np.einsum("ga,fai->fgi", e.N, X[conn]).reshape(-1, 3)
        items = np.arange(len(conn)) if items is None else np.asarray(items)
        return cls(conn, e, points, np.repeat(items, e.npoints))

    @property
    def geometry(self) -> tuple[Ints, Floats, Floats, Floats]:
        return self.conn, self.element.N, self.element.dN, self.element.weights


def patches(
    facets: dict[str, Ints], X: Floats, order: dict[str, Ints] | None = None,
    rules: dict[str, str] | None = None,
) -> tuple[Patch, ...]:
    """Patches of a surface given as facet type -> (facet, node).

    ``order``: type -> row of each facet in the surface; ``rules``: type -> integration rule.
    """
    rows, rules = order or {}, rules or {}
    return tuple(Patch.of(k, c, X, rows.get(k), rules.get(k)) for k, c in facets.items() if len(c))


def scalar(v: Number, t: float, patch: Patch) -> Floats:
    """A value at the points of a patch: (1,) or (f g,)."""
    return np.ascontiguousarray(as_value(v)(t, patch.points, patch.items), dtype=float)


def vector(v: Vector, t: float, X: Floats, items: Ints) -> Floats:
    """Three values at points: (1|n, 3)."""
    parts = [as_value(x)(t, X, items) for x in v]
    out = np.empty((max(len(c) for c in parts), 3))
    for i, c in enumerate(parts):
        out[:, i] = c
    return out


def as_vector(v: Vector) -> tuple[Value, ...]:
    if len(v) != 3:
        raise ValueError(f"a vector has 3 components, not {len(v)}")
    return tuple(as_value(x) for x in v)


@variable_record
class SurfaceLoad(Action):
    """A load on facets.

    ``shell_bottom`` says that the facets are the bottom faces of shells (their nodes those of
    :mod:`..shells`), numbered like the top faces, so that their normals point into the shell.
    """

    surface: tuple[Patch, ...]
    shell_bottom: bool = field(default=False, kw_only=True)
    parameters: ClassVar[tuple[str, ...]] = ()
    vectors: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        for name in self.parameters:
            v: Any = getattr(self, name)
            setattr(self, name, as_vector(v) if name in self.vectors else as_value(v))

    @property
    def tangent(self) -> bool:
        """True where the load adds to the tangent."""
        return False

    def cliques(self) -> list[Ints]:
        return [p.conn for p in self.surface] if self.tangent else []

    @property
    def sign(self) -> float:
        return -1.0 if self.shell_bottom else 1.0

    def positions(self, state: State, reference: bool = False) -> Floats:
        """Nodal positions (node, 3)."""
        return state.X if reference else state.x

    def pressure_of(self, state: State) -> Floats | None:
        """Nodal fluid pressure (node,), or None where the model has none."""
        return state.p

    def add(self, state: State, patch: Patch, f: Floats, R: Floats) -> None:
        """Add facet forces f (f, n, 3) to R."""
        add_vectors(patch.conn, f, state.layout.u(R))

    def matrices(self, state: State, patch: Patch, *fields: str) -> tuple[Floats, Ints, Ints]:
        """Zero matrices of a patch with their unknowns, component by component, of the displacement and ``fields``."""
        own = state.layout.columns(DISPLACEMENT.name, *fields)
        n, c = patch.conn.shape[1], len(own)
        return np.zeros((len(patch.conn), c * n, c * n)), np.tile(patch.conn, (1, c)), np.repeat(own, n)

    def residual(self, state: State, R: Floats) -> None:
        """Add its forces to R."""
        raise NotImplementedError


__all__ = ["Floats", "Ints", "Matrices", "Number", "Patch", "SurfaceLoad", "Vector"]
