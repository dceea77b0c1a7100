"""Equation numbers and sparsity of one analysis step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .graph import Graph, MakeGraph
from .linear.base import Matrix
from .problem import Fixed, Prescribed
from .record import record

if TYPE_CHECKING:
    from .group import Group
    from .schedule import Schedule
    from .ties import Ties

Ints = NDArray[np.int32]
INACTIVE, FREE, HELD, GIVEN = -1, 0, 1, 2  # what becomes of a nodal unknown


class Equations:
    """Numbers unknowns node by node: ``eq`` (node, column), -1 where fixed or absent.

    Prescribed unknowns get numbers too; ``free`` (equation) is the row
    in the matrix, or -1 where prescribed.
    """

    def __init__(self, active: NDArray[np.bool_], conditions: list[Fixed | Prescribed]) -> None:
        kind = np.where(active, FREE, INACTIVE).astype(np.int8)
        for c in conditions:
            nodes = c.nodes[active[c.nodes, c.column]]
            if isinstance(c, Fixed):
                kind[nodes[kind[nodes, c.column] == FREE], c.column] = HELD
            else:
                kind[nodes, c.column] = GIVEN
        self.kind = kind
        numbered = (kind == FREE) | (kind == GIVEN)
        self.eq = np.full(kind.shape, -1, np.int32)
        self.eq[numbered] = np.arange(numbered.sum(), dtype=np.int32)
        self.n = int(numbered.sum())
        given = kind[numbered] == GIVEN
        self.free = np.full(self.n, -1, np.int32)
        self.free[~given] = np.arange((~given).sum(), dtype=np.int32)
        self.rows = np.flatnonzero(~given)  # equation of each matrix row
        self.given = np.flatnonzero(given)
        self.column = np.broadcast_to(np.arange(kind.shape[1]), kind.shape)[numbered]
        self.numbered = numbered
        self.is_free, self.is_given = kind == FREE, kind == GIVEN  # (node, column)
        self.not_given = ~self.is_given
        # places of the free ones and the given ones in nodal arrays, row by row: faster than masks
        self.free_places, self.given_places = map(np.flatnonzero, (self.is_free, self.is_given))
        self.size = self.is_free.sum(axis=1).astype(np.int32)
        self.lead = np.zeros(len(kind), np.int32)
        self.lead[1:] = np.cumsum(self.size)[:-1]


@record
class Unknowns:
    """A group's own columns: matrix row of each unknown of a node (node, c), equation of each prescribed one, -1 else.

    ``size`` (node,): number of the columns where all are free and their rows follow each other, else -1.
    ``ordered``: the columns ascend.
    """

    row: Ints
    given: Ints
    size: Ints
    ordered: bool


class Pattern:
    """Compressed rows of the tangent for groups of elements and extra node cliques (loads, contact)."""

    def __init__(
        self, eqs: Equations, groups: list[Group], cliques: list[NDArray], symmetric: bool, schedule: Schedule,
        ties: Ties | None = None, graph: MakeGraph = Graph,
    ) -> None:  # fmt: skip
        self.eqs, self.symmetric = eqs, symmetric
        self.lead = eqs.lead
        # matrix row of each nodal unknown, and equation of each prescribed one; -1 for the others
        at = np.where(eqs.eq >= 0, eqs.free[eqs.eq], -1) if eqs.n else eqs.eq
        self.row = np.ascontiguousarray(at, dtype=np.int32)
        self.given = np.where(self.row < 0, eqs.eq, -1).astype(np.int32)
        nn = len(eqs.kind)
        parts = [g.conn for g in groups] + [np.asarray(c, np.int32) for c in cliques]
        self.ties = ties
        self._tied: dict[int, NDArray[np.int64]] = {}
        if ties is not None:
            self._tied = {id(g): ties.rows(g.conn) for g in groups}
            parts += ties.cliques(parts)
        self.graph = graph(parts, eqs.size, symmetric)
        self.indptr, self.indices = self.graph.indptr, self.graph.indices
        self._unknowns: dict[tuple[int, ...], Unknowns] = {}
        for g in groups:
            self._take(g.columns)
        self._back: dict[int, NDArray[np.int32]] = {id(g): self.graph.back(k) for k, g in enumerate(groups)}
        self._contended = schedule.contended(groups, nn)
        # no thread owns the right side, to which prescribed columns go, nor the rows of masters
        shared = np.asarray((self.given >= 0).any(axis=1))
        if ties is not None:
            shared[ties.master // ties.columns] = True
        for g in groups:
            self._contended[id(g)] |= shared[g.conn].any(axis=1)

    def _take(self, columns: NDArray[np.int64]) -> None:
        """What scatters to these columns need."""
        key = tuple(columns.tolist())
        if key in self._unknowns:
            return
        whole = key == tuple(range(self.row.shape[1]))
        row = self.row if whole else np.ascontiguousarray(self.row[:, columns])
        given = self.given if whole else np.ascontiguousarray(self.given[:, columns])
        in_a_row = (row == self.lead[:, None] + np.arange(len(key))).all(axis=1)
        size = np.where(in_a_row, len(key), -1).astype(np.int32)
        self._unknowns[key] = Unknowns(row, given, size, list(key) == sorted(key))

    def unknowns(self, group: Group) -> Unknowns:
        """Rows and equations of a group's own columns."""
        return self._unknowns[tuple(group.columns.tolist())]

    def back(self, group: Group) -> NDArray[np.int32]:
        """Offsets of a group's node pairs from the row ends."""
        return self._back[id(group)]

    def tied(self, group: Group, lo: int, hi: int) -> NDArray[np.int64]:
        """Those of a group's elements lo:hi that have tied nodes."""
        rows = self._tied[id(group)]
        return rows[np.searchsorted(rows, lo) : np.searchsorted(rows, hi)]

    def contended(self, group: Group) -> NDArray[np.bool_]:
        """Elements of a group whose entries more than one thread may add to."""
        return self._contended[id(group)]

    def holds(self, cliques: list[NDArray[np.int32]]) -> bool:
        """Does the pattern have an entry for every pair of nodes of the cliques (m, n), padded with -1?"""
        return all(self.graph.holds(c) for c in cliques)

    def matrix(self) -> Matrix:
        """A zero matrix of this pattern (the pattern arrays are shared)."""
        return Matrix(self.indptr, self.indices, np.zeros(len(self.indices)), self.symmetric, self.graph.kept)
