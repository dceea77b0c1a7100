"""What a contact is: two surfaces that act on each other, and whose neighbours may change (:mod:`..action`).

Beside what all that acts has, a contact has ``update(state, progress)``, which projects the surfaces on each other at
the present state; ``cliques()`` are the nodes that the present stiffness couples.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..action import Action, Matrices
from ..kernels import closest, facets, ray
from ..kernels import contact as kernels
from ..problem import Progress
from ..values import as_value
from .surface import Facets, Floats, Ints, Surface

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


class Side:
    """Points of one surface and their partners on the other; arrays named in ``memory`` are given back by retries.

    ``facets`` (conn, count), ``facet``, N: what a point acts on (for nodes: facets of one node).
    """

    memory: tuple[str, ...] = ("partner", "rs")

    def __init__(self, surface: Surface, other: Surface, nodal: bool) -> None:
        self.surface, self.other, self.nodal = surface, other, nodal
        if nodal:
            self.conn, n = surface.nodes[:, None].copy(), len(surface.nodes)
            self.count, self.facet = np.ones(n, np.int64), np.arange(n)
            self.N = np.ones((n, 9))
        else:
            self.conn, self.count, self.facet = surface.conn, surface.count, surface.facet
            self.N, n = surface.N, len(surface.facet)
        self.n = n
        self.partner = np.full(n, -1, np.int64)
        self.rs = np.zeros((n, 2))
        self.M, self.place = np.zeros((n, 9)), np.zeros((n, 3))
        self.modulus = np.ones(n)  # factor of the penalty
        self.points, self.normals, self.detJ = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n)

    @property
    def reference_area(self) -> Floats:
        """Reference area that each point stands for (q,)."""
        return self.surface.nodal_area if self.nodal else self.surface.reference_weight

    def frames(self, x: Floats) -> None:
        """Positions, normals and areas at integration points."""
        s = self.surface
        facets.frames(x, s.conn, s.count, s.facet, s.N, s.G, self.points, self.normals, self.detJ)

    def positions(self, x: Floats) -> Floats:
        """Where the points are (q, 3)."""
        if self.nodal:
            return np.asarray(x[self.surface.nodes])
        self.frames(x)
        return self.points

    def closest(
        self, x: Floats, tol: float, radius: float, special: bool, keep: bool = True, update: bool = True,
        itself: bool = False,
    ) -> None:  # fmt: skip
        """Project the points on the other surface; see :func:`..kernels.closest.follow`.

        ``itself``: a point does not meet the facets that it belongs to.
        """
        o = self.other
        if update:
            o.node_tree.fit(x, 0.0)
        node, facet = self._own if itself else (self._none, self._none)
        first, star = o.star
        closest.follow(
            o.T, x, o.conn, o.count, o.nodes, o.local, o.neighbours, first, star, o.node_tree.order,
            o.node_tree.boxes, self.positions(x), node, facet, tol, radius, special, keep, update, self.partner,
            self.rs, self.place,
        )  # fmt: skip

    def search(self, x: Floats, points: Floats, tol: float, special: bool) -> tuple[Ints, Floats, Floats]:
        """Where any points (k, 3) are closest to the other surface: facets or -1 (k,), coordinates (k, 2), places."""
        o, k = self.other, len(points)
        o.node_tree.fit(x, 0.0)
        first, star = o.star
        partner, rs, place = np.full(k, -1), np.zeros((k, 2)), np.zeros((k, 3))
        closest.follow(
            o.T, x, o.conn, o.count, o.nodes, o.local, o.neighbours, first, star, o.node_tree.order,
            o.node_tree.boxes, points, np.full(k, -1), np.full(k, -1), tol, 0.0, special, False, True, partner, rs,
            place,
        )  # fmt: skip
        return partner, rs, place

    @cached_property
    def _none(self) -> Ints:
        return np.full(self.n, -1)

    @cached_property
    def _own(self) -> tuple[Ints, Ints]:
        """Node and facet of the other surface that each point belongs to, or -1."""
        if self.nodal:
            return self.other.find_nodes(self.surface.nodes), self._none
        return self._none, self.other.find_facets(self.surface)[self.facet]

    def meet(
        self, x: Floats, tol: float, radius: float, absolute: bool, keep: bool = True, update: bool = True
    ) -> None:
        """Send rays along the normals of :meth:`frames` to the other surface; see :func:`..kernels.ray.find`."""
        o = self.other
        if update:
            o.facet_tree.fit(x, 2 * tol)
        ray.find(
            o.T, x, o.conn, o.count, o.facet_tree.order, o.facet_tree.boxes, self.points, self.normals, tol, radius,
            absolute, keep, update, self.partner, self.rs,
        )  # fmt: skip

    def shapes(self, x: Floats) -> None:
        """Shape functions and positions of the partners at ``rs``."""
        o = self.other
        kernels.partners(o.T, x, o.conn, o.count, self.partner, self.rs, self.M, self.place)

    def spread(self, state: State, t: Floats, R: Floats) -> None:
        """Add forces t (q, 3) of the points on both surfaces to R (node, column)."""
        o = self.other
        kernels.spread(
            self.conn, self.count, self.facet, self.N, o.conn, o.count, self.partner, self.M, t, state.layout.u(R)
        )  # fmt: skip

    def pairs(self, active: NDArray[np.bool_]) -> Iterator[tuple[Ints, int, int, Ints]]:
        """Points that act (q,), by numbers of nodes: (rows, primary, secondary, nodes (rows, both))."""
        rows = np.flatnonzero(active & (self.partner >= 0))
        if not len(rows):
            return
        ns, nm = self.count[self.facet[rows]], self.other.count[self.partner[rows]]
        for code in np.unique(ns * 10 + nm):
            a, b = int(code) // 10, int(code) % 10
            some = rows[(ns == a) & (nm == b)]
            nodes = np.hstack([self.conn[self.facet[some], :a], self.other.conn[self.partner[some], :b]])
            yield some, a, b, nodes

    def couples(self) -> Ints:
        """Nodes of both facets of all points that have a partner, -1 where a facet has fewer."""
        rows = np.flatnonzero(self.partner >= 0)
        if not len(rows):
            return np.zeros((0, self.conn.shape[1] + 9), np.int64)
        pair = np.unique(self.facet[rows] * len(self.other.conn) + self.partner[rows])
        first, second = np.divmod(pair, len(self.other.conn))
        return np.hstack([self.conn[first], self.other.conn[second]])

    def snapshot(self) -> dict[str, Any]:
        return {k: np.copy(getattr(self, k)) for k in self.memory}

    def restore(self, saved: dict[str, Any]) -> None:
        for k, v in saved.items():
            setattr(self, k, v.copy())


def matrices(state: State, nodes: Ints) -> tuple[Floats, Ints, Ints]:
    """Zero matrices over the displacements of ``nodes`` (m, n), node by node, with their unknowns."""
    m, n = nodes.shape
    return np.zeros((m, 3 * n, 3 * n)), np.repeat(nodes, 3, axis=1), np.tile(state.layout.displacement, n)


@dataclass(eq=False)
class Contact(Action):
    """A pair of surfaces; ``penalty`` may change with time. ``laugon``: multipliers are augmented."""

    primary: Facets
    secondary: Facets
    penalty: Any = 1.0  # a Value
    laugon: bool = False
    tolerance: float = 0.1
    minaug: int = 0
    maxaug: int = 10
    names: tuple[str, str] = ("", "")  # of the surfaces, for output
    two_pass: bool = field(default=False, kw_only=True)  # both surfaces act as primary ones
    nodal: ClassVar[bool] = False
    side: ClassVar[type[Side]] = Side
    retraces: ClassVar[bool] = False
    erodes: ClassVar[bool] = False  # it goes on once facets are taken away (:mod:`..erosion`)
    drains: ClassVar[bool] = False  # ``drained(state)``: nodes held at ``ambient(state)``, by field

    def __post_init__(self) -> None:
        self.eroded = False  # are the surfaces no longer those of the model?
        self.penalty = as_value(self.penalty)
        self.sides: list[Side] = []

    @property
    def augments(self) -> bool:
        return self.laugon

    @property
    def passes(self) -> list[Side]:
        """The sides that act as primary ones."""
        return self.sides if self.two_pass else self.sides[:1]

    def scale(self, state: State) -> float:
        """The penalty at the present time."""
        return float(self.penalty(state.time, state.X[:1], np.zeros(1, np.int64))[0])

    def open(self, state: State) -> None:
        """Set up the sides."""
        a, b = Surface(self.primary, state.X), Surface(self.secondary, state.X)
        self.sides = [self.side(a, b, self.nodal), self.side(b, a, self.nodal)]

    def begin(self, state: State, groups: list[Group]) -> None:
        """Open the sides and find the partners of their points."""
        raise NotImplementedError

    def update(self, state: State, progress: Progress) -> None:
        raise NotImplementedError

    def residual(self, state: State, R: Floats) -> None:
        raise NotImplementedError

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        raise NotImplementedError

    def pressure(self, s: Side, state: State) -> Floats:
        """Pressure at the points of a side (q,)."""
        raise NotImplementedError

    def bearing(self, s: Side, state: State) -> Floats:
        """As :meth:`pressure`, from the present gaps, where that waits for the residual."""
        return self.pressure(s, state)

    def net_pressure(self, s: Side, state: State) -> Floats:
        """Pressure (q,) with what the other surface's own pass adds where there are two."""
        p = self.bearing(s, state)
        if len(self.passes) < 2:
            return p
        o = next(q for q in self.sides if q is not s)
        other = self.bearing(o, state)
        at = np.where(o.surface.local >= 0, other[o.surface.local], 0.0) if o.nodal else o.surface.to_nodes(other)
        return p + np.where(s.partner >= 0, np.maximum((s.M * at[s.partner]).sum(axis=1), 0.0), 0.0)

    def values(self, s: Side, what: str, state: State) -> Floats | None:
        """The "gap", "pressure" or "traction" at the points of a side that acts; None where there is no such thing."""
        raise NotImplementedError

    def on_facets(self, what: str, state: State) -> list[Floats] | None:
        """Means over the facets of both surfaces of what :meth:`values` gives; zero on one that does not act."""
        out = []
        for s in self.sides:
            v = self.values(s, what, state) if s in self.passes else np.zeros((s.n, *[3] * (what == "traction")))
            if v is None:
                return None
            out.append(s.surface.means(v, s.nodal))
        return out

    def cliques(self) -> list[Ints]:
        return [c for s in self.passes if len(c := s.couples())]

    def snapshot(self) -> Any:
        return [s.snapshot() for s in self.sides]

    def restore(self, saved: Any) -> None:
        for s, q in zip(self.sides, saved, strict=True):
            s.restore(q)


__all__ = ["Contact", "Facets", "Floats", "Ints", "Matrices", "Progress", "Side", "Surface", "matrices"]
