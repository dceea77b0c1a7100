"""A contact surface: its facets, their integration points, and what a search needs to know of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from .. import elements
from ..elements import nodal
from ..kernels import tree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
INVERTED = {
    "tri3": (0, 2, 1), "tri6": (0, 2, 1, 5, 4, 3), "tri7": (0, 2, 1, 5, 4, 3, 6), "quad4": (0, 3, 2, 1),
    "quad8": (0, 3, 2, 1, 7, 6, 5, 4), "quad9": (0, 3, 2, 1, 7, 6, 5, 4, 8),
}  # fmt: skip


@cache
def polynomials() -> Floats:
    """Shape functions of the facets that may be in contact, as the kernels take them (see :mod:`..kernels.facets`)."""
    T = np.zeros((10, 10, 11))
    for name in INVERTED:
        e = elements.get(name)
        k = len(e.exponents)
        T[e.nodes, :k, :2] = e.exponents
        T[e.nodes, :k, 2 : 2 + e.nodes] = e.coefficients
        T[e.nodes, 9, 0] = k
    return T


@dataclass(eq=False)
class Facets:
    """Facets of a contact surface as a scene gives them: type -> nodes (f, n).

    ``owner``: type -> (f, 2), the block and the element that a facet belongs to, or -1; ``modulus``: type -> (f,),
    the penalty modulus E / (1 - nu^2) A / V of facets of rigid bodies, which belong to no block; ``rules``: type ->
    integration rule where it is not FEBio's default; ``offset`` (node,): half the thickness of shells, or None.
    """

    conn: dict[str, Ints]
    owner: dict[str, Ints] = field(default_factory=dict)
    modulus: dict[str, Floats] = field(default_factory=dict)
    rules: dict[str, str] = field(default_factory=dict)
    offset: Floats | None = None

    def inverted(self) -> Facets:
        """The same facets facing the other way."""
        turned = {k: np.ascontiguousarray(c[:, INVERTED[k]]) for k, c in self.conn.items()}
        return Facets(turned, self.owner, self.modulus, self.rules, self.offset)


class Surface:
    """Facets one after the other, whatever their types.

    conn (f, 9) nodes padded with -1, count (f,) how many there are; nodes (m,): the surface's nodes, local (f, 9)
    their places in ``nodes``. Integration points (q,): facet, N (q, 9), G (q, 9, 2), weight.
    """

    def __init__(self, given: Facets, X: Floats) -> None:
        self.given, self.X = given, X
        parts = [(k, np.asarray(c, np.int64)) for k, c in given.conn.items() if len(c)]
        f = sum(len(c) for _, c in parts)
        self.conn = np.full((f, 9), -1, np.int64)
        self.count = np.zeros(f, np.int64)
        self.kinds: list[tuple[str, slice]] = []
        row = 0
        for kind, c in parts:
            self.conn[row : row + len(c), : c.shape[1]] = c
            self.count[row : row + len(c)] = c.shape[1]
            self.kinds.append((kind, slice(row, row + len(c))))
            row += len(c)
        self.nodes, self.local = self._nodes()
        self.T = polynomials()
        self._points()

    def _nodes(self) -> tuple[Ints, Ints]:
        """The nodes in the order the facets meet them, and their places in it."""
        flat = self.conn[self.conn >= 0]
        nodes, at, inverse = np.unique(flat, return_index=True, return_inverse=True)
        order = np.argsort(at, kind="stable")
        rank = np.empty(len(nodes), np.int64)
        rank[order] = np.arange(len(nodes))
        local = np.full(self.conn.shape, -1, np.int64)
        local[self.conn >= 0] = rank[inverse]
        return nodes[order], local

    def _points(self) -> None:
        facet, N, G, weight = [], [], [], []
        for kind, rows in self.kinds:
            e = elements.get(kind, self.given.rules.get(kind))
            m, g = rows.stop - rows.start, e.npoints
            facet.append(np.repeat(np.arange(rows.start, rows.stop), g))
            n = np.zeros((g, 9))
            n[:, : e.nodes] = e.N
            d = np.zeros((g, 9, 2))
            d[:, : e.nodes] = e.dN
            N.append(np.tile(n, (m, 1)))
            G.append(np.tile(d, (m, 1, 1)))
            weight.append(np.tile(e.weights, m))
        self.facet = np.concatenate(facet) if facet else np.zeros(0, np.int64)
        self.N = np.concatenate(N) if N else np.zeros((0, 9))
        self.G = np.concatenate(G) if G else np.zeros((0, 9, 2))
        self.weight = np.concatenate(weight) if weight else np.zeros(0)

    # ---- what a search needs ----------------------------------------------------------------------
    @cached_property
    def star(self) -> tuple[Ints, Ints]:
        """Facets around each node: first (m + 1,) and facets."""
        flat, facet = self.local.ravel(), np.repeat(np.arange(len(self.conn)), 9)
        keep = flat >= 0
        flat, facet = flat[keep], facet[keep]
        first = np.zeros(len(self.nodes) + 1, np.int64)
        np.cumsum(np.bincount(flat, minlength=len(self.nodes)), out=first[1:])
        return first, facet[np.argsort(flat, kind="stable")]

    @cached_property
    def neighbours(self) -> Ints:
        """Facets (f, 4) that share an edge with each facet, -1 at the border."""
        f = len(self.conn)
        sides = np.where(np.isin(self.count, (4, 8, 9)), 4, 3)
        e, k = np.nonzero(np.arange(4)[None] < sides[:, None])
        ends = np.sort(np.stack([self.conn[e, k], self.conn[e, (k + 1) % sides[e]]], axis=1), axis=1)
        code = ends[:, 0] * (self.X.shape[0] + 1) + ends[:, 1]
        order = np.argsort(code, kind="stable")
        same = np.flatnonzero(code[order][1:] == code[order][:-1])
        a, b = order[same], order[same + 1]
        out = np.full((f, 4), -1, np.int64)
        out[e[a], k[a]], out[e[b], k[b]] = e[b], e[a]
        return out

    @cached_property
    def facet_tree(self) -> Tree:
        return Tree(self.conn, self.count, self.X)

    @cached_property
    def node_tree(self) -> Tree:
        return Tree(self.nodes[:, None].copy(), np.ones(len(self.nodes), np.int64), self.X)

    def find_nodes(self, nodes: Ints) -> Ints:
        """The given nodes where they belong to this surface, -1 elsewhere."""
        return np.where(np.isin(nodes, self.nodes), nodes, -1)

    def find_facets(self, other: Surface) -> Ints:
        """For each facet of another surface: the same facet here, or -1."""
        mine = {tuple(sorted(c[:n])): k for k, (c, n) in enumerate(zip(self.conn, self.count, strict=True))}
        if not np.isin(other.nodes, self.nodes).any():
            return np.full(len(other.conn), -1)
        found = (mine.get(tuple(sorted(c[:n])), -1) for c, n in zip(other.conn, other.count, strict=True))
        return np.fromiter(found, np.int64, len(other.conn))

    # ---- values on facets -------------------------------------------------------------------------
    def to_nodes(self, values: Floats) -> Floats:
        """Values of integration points (q,) at the nodes of each facet (f, 9)."""
        out, start = np.zeros((len(self.conn), 9)), 0
        for kind, rows in self.kinds:
            e = elements.get(kind, self.given.rules.get(kind))
            m = rows.stop - rows.start
            part = values[start : start + m * e.npoints].reshape(m, -1)
            out[rows, : e.nodes] = part @ e.extrapolation.T
            start += m * e.npoints
        return out

    def means(self, values: Floats, nodal: bool) -> Floats:
        """Means (f, ...) of values of integration points (q, ...), or of nodes (m, ...), over each facet."""
        if nodal:
            inside = (self.local >= 0).reshape(*self.local.shape, *[1] * (values.ndim - 1))
            total = np.where(inside, values[self.local], 0.0).sum(axis=1)
            return np.asarray(total / self.count.reshape(-1, *[1] * (values.ndim - 1)))
        total = np.zeros((len(self.conn), *values.shape[1:]))
        np.add.at(total, self.facet, values)
        points = np.bincount(self.facet, minlength=len(self.conn))
        return np.asarray(total / points.reshape(-1, *[1] * (values.ndim - 1)))

    # ---- reference measures -----------------------------------------------------------------------
    @cached_property
    def reference_weight(self) -> Floats:
        """Weight times reference area per natural area at integration points (q,)."""
        X = self.X[np.maximum(self.conn, 0)][self.facet]
        t = np.einsum("qaj,qai->qji", self.G, X)
        return np.asarray(self.weight * np.linalg.norm(np.cross(t[:, 0], t[:, 1]), axis=1))

    @cached_property
    def area(self) -> Floats:
        """Reference areas of the facets (f,)."""
        return np.asarray(np.bincount(self.facet, self.reference_weight, len(self.conn)), float)

    @cached_property
    def nodal_area(self) -> Floats:
        """Reference area of each node (m,) by FEBio's nodal rules."""
        out = np.zeros(len(self.nodes))
        for kind, rows in self.kinds:
            n = elements.get(kind).nodes
            np.add.at(out, self.local[rows][:, :n], nodal.areas(kind, self.X[self.conn[rows][:, :n]]))
        return out

    def nodal_normals(self, x: Floats) -> Floats:
        """Unit normals (m, 3) of the nodes at positions x: means over the facets' corners."""
        out = np.zeros((len(self.nodes), 3))
        for kind, rows in self.kinds:
            n = elements.get(kind).nodes
            y = x[self.conn[rows, :n]]
            turn = np.cross(np.roll(y, -1, axis=1) - y, np.roll(y, 1, axis=1) - y)
            np.add.at(out, self.local[rows, :n], turn)
        size = np.linalg.norm(out, axis=1)[:, None]
        return np.asarray(out / np.where(size > 0.0, size, 1.0))

    @cached_property
    def shell_offset(self) -> Floats:
        """Half the thickness of shells at the nodes (m,)."""
        given = self.given.offset
        return np.zeros(len(self.nodes)) if given is None else given[self.nodes]


class Tree:
    """Boxes around items (conn, count) for searches (see :mod:`..kernels.tree`)."""

    def __init__(self, conn: Ints, count: Ints, X: Floats) -> None:
        self.conn, self.count = conn, count
        used = (conn >= 0)[:, :, None]
        centre = (X[np.maximum(conn, 0)] * used).sum(axis=1) / count[:, None]
        self.order = np.argsort(_morton(centre), kind="stable")
        leaves = 1
        while len(conn) > 4 * leaves:
            leaves *= 2
        self.boxes = np.empty((2 * leaves - 1, 6))

    def fit(self, x: Floats, margin: float) -> None:
        tree.fit(x, self.conn, self.count, self.order, margin, self.boxes)


def _morton(x: Floats) -> Ints:
    """Places of points along a curve that fills their box."""
    lo, size = x.min(axis=0), np.ptp(x, axis=0).max() or 1.0
    cell = np.minimum((x - lo) / size * 1024, 1023).astype(np.int64)
    code = np.zeros(len(x), np.int64)
    for bit in range(10):
        for i in range(3):
            code |= ((cell[:, i] >> bit) & 1) << (3 * bit + i)
    return code
