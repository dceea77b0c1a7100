"""What refinement makes of a mesh: new nodes, children of elements and of facets, nodes that hang."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .topology import Topology

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Hanging = dict[int, tuple[int, ...]]  # node -> nodes whose mean it is

# facets of a split facet by its corners, the middles of its edges (1-2, 2-3, ...), and its middle
QUARTERS = {"quad4": ((0, 4, 8, 7), (4, 1, 5, 8), (7, 8, 6, 3), (8, 5, 2, 6)),
            "tri3": ((0, 3, 5), (1, 4, 3), (2, 5, 4), (3, 4, 5))}  # fmt: skip
HALVES = {True: ((0, 4, 6, 3), (1, 2, 6, 4)), False: ((0, 1, 5, 7), (2, 3, 7, 5))}  # of a quad: is edge 1-2 split?


@dataclass(frozen=True, eq=False)
class Split:
    """``masters`` (k, 8): nodes whose mean each new node is, padded with -1; a row of -1: a node that nothing has, at
    the origin. ``conn``: all elements afterwards, ``parent`` the one before that each is of. ``edges`` and ``faces``:
    node at the middle of each edge and face of ``of``, -1 where it is not split; ``halved`` faces are cut in two.
    ``hanging``: nodes on edges and faces of larger elements afterwards."""

    of: Topology
    masters: Ints
    conn: Ints
    parent: Ints
    edges: Ints
    faces: Ints
    halved: NDArray[np.bool_]
    hanging: Hanging

    def means(self, values: Floats) -> Floats:
        """Values of the nodes before (node, ...) with those of the new nodes below."""
        there = self.masters >= 0
        count = there.sum(axis=1)
        total = np.zeros((len(self.masters), *values.shape[1:]))
        for k in range(self.masters.shape[1]):  # one after another, as FEBio adds
            own = there[:, k]
            total[own] += values[self.masters[own, k]]
        shape = (-1,) + (1,) * (values.ndim - 1)
        return np.concatenate([values, total / np.maximum(count, 1).reshape(shape)])

    def among(self, nodes: Ints) -> Ints:
        """A set of nodes with the middles of edges and faces all of whose corners are in it."""
        own = np.zeros(self.of.nodes, bool)
        own[nodes] = True
        found = [
            at[(at >= 0) & own[corners].all(axis=1)]
            for at, corners in ((self.edges, self.of.edges), (self.faces, self.of.faces))
        ]
        new = np.concatenate(found)
        return np.concatenate([nodes, new[~np.isin(new, nodes)]])

    def facets(self, kind: str, facets: Ints) -> tuple[Ints, Ints]:
        """Facets (f, k) afterwards, and the one before that each is of."""
        at = self.of.face(facets)
        own = np.flatnonzero(at >= 0)
        table = np.hstack([facets, np.full((len(facets), facets.shape[1] + 1), -1)])
        turned = np.roll(facets[own], -1, axis=1)
        table[own, facets.shape[1] : -1] = self.edges[self.of.edge(facets[own], turned)]
        table[own, -1] = self.faces[at[own]]
        cuts = [self._cuts(kind, f, row[facets.shape[1] :]) for f, row in zip(at, table, strict=True)]
        parent = np.repeat(np.arange(len(facets)), list(map(len, cuts)))
        return np.concatenate([facets[:0], *(row[c] for row, c in zip(table, cuts))]), parent

    def _cuts(self, kind: str, face: int, middle: Ints) -> Ints:
        """Corners of the pieces of a facet by its nodes: corners, middles of its edges, and its own."""
        if face >= 0 and self.halved[face]:
            return np.array(HALVES[bool(middle[0] >= 0)])
        if (middle[-1] if kind == "quad4" else middle[:-1].min()) >= 0:
            return np.array(QUARTERS[kind])
        return np.arange(len(middle) - 1)[None]


def children(conn: Ints, chosen: NDArray[np.bool_], table: Ints, pieces: Ints) -> tuple[Ints, Ints]:
    """Elements after those ``chosen`` (m,) are cut, in place, into ``pieces`` (c, n) by columns of ``table`` (m, .)."""
    count = np.where(chosen, len(pieces), 1)
    parent = np.repeat(np.arange(len(conn)), count)
    child = np.arange(len(parent)) - np.repeat(np.cumsum(count) - count, count)
    out = conn[parent].copy()
    cut = chosen[parent]
    out[cut] = np.take_along_axis(table[parent[cut]], pieces[child[cut]], axis=1)
    return out, parent


def padded(*lists: Ints) -> Ints:
    """Lists of nodes (k, n) below each other, eight columns wide."""
    return np.concatenate([np.pad(a, ((0, 0), (0, 8 - a.shape[1])), constant_values=-1) for a in lists])
