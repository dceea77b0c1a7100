"""Faces and edges of a mesh of one element type, in the order in which FEBio numbers them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import elements

Ints = NDArray[np.int64]
# edges by the local numbers of their ends (FEBio's order, which that of new nodes follows)
EDGES = {
    "hex8": ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    "tet4": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
}


class Topology:
    """Of elements ``conn`` (m, n) of a type with labels ``ids`` (m,), among ``nodes`` nodes.

    ``faces`` (f, k) by the nodes of the element of the least label that has them, in the order of these elements;
    ``edges`` (e, 2) by ascending ends; ``element_faces`` (m, .), ``element_edges`` (m, .), ``face_edges`` (f, k).
    """

    def __init__(self, element: str, conn: Ints, ids: Ints, nodes: int) -> None:
        self.element, self.conn, self.nodes = element, conn, nodes
        ends = conn[:, np.array(EDGES[element])]
        codes, which = np.unique(self._codes(ends), return_inverse=True)
        self._edges = codes
        self.edges = np.stack([codes // nodes, codes % nodes], axis=1)
        self.element_edges = which.reshape(ends.shape[:2])
        self._take_faces(ids)
        self.face_edges = self.edge(self.faces, np.roll(self.faces, -1, axis=1))

    def _codes(self, ends: Ints) -> Ints:
        """A number for each pair of nodes (..., 2), whichever comes first."""
        return np.asarray(ends.min(axis=-1) * self.nodes + ends.max(axis=-1), np.int64)

    def _take_faces(self, ids: Ints) -> None:
        local = np.array([nodes for _, nodes in elements.get(self.element).facets])
        every = self.conn[:, local].reshape(-1, local.shape[1])
        self._keys, which = np.unique(np.sort(every, axis=1), axis=0, return_inverse=True)
        which = which.reshape(-1)
        order = np.lexsort((np.repeat(ids, len(local)), which))
        first = order[np.searchsorted(which[order], np.arange(len(self._keys)))]
        self._number = np.argsort(np.argsort(first))  # of each face among the sorted keys
        self.faces = every[np.sort(first)]
        self.element_faces = self._number[which].reshape(-1, len(local))

    def edge(self, a: Ints, b: Ints) -> Ints:
        """Numbers of the edges between nodes a and b of the mesh, all of which there are."""
        return np.searchsorted(self._edges, self._codes(np.stack([a, b], axis=-1)))

    def face(self, facets: Ints) -> Ints:
        """Numbers of the faces of these nodes (f, k), -1 where there is none."""
        both, which = np.unique(np.vstack([self._keys, np.sort(facets, axis=1)]), axis=0, return_inverse=True)
        at = np.full(len(both), -1)
        at[which.reshape(-1)[: len(self._keys)]] = self._number
        return at[which.reshape(-1)[len(self._keys) :]]
