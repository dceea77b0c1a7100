"""Equation numbers and sparsity of one analysis step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .kernels import pattern as kernels
from .linear.base import Matrix
from .problem import Fixed, Prescribed

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
        self.size = self.is_free.sum(axis=1).astype(np.int32)
        self.lead = np.zeros(len(kind), np.int32)
        self.lead[1:] = np.cumsum(self.size)[:-1]


@dataclass(frozen=True, slots=True, eq=False)
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
        ties: Ties | None = None,
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
        conn = self._stack(parts)
        ptr, elems = self._incidence(conn, nn)
        first = np.zeros(nn + 1, np.int64)
        kernels.node_graph(ptr, elems, conn, symmetric, first, True, np.empty(0, np.int32))
        nbr = np.empty(first[-1], np.int32)
        kernels.node_graph(ptr, elems, conn, symmetric, first, False, nbr)
        self._first, self._nbr = first, nbr
        self._rows(first, nbr, nn)
        self._unknowns: dict[tuple[int, ...], Unknowns] = {}
        for g in groups:
            self._take(g.columns)
        self._back: dict[int, NDArray[np.int32]] = {id(g): self._offsets(g) for g in groups}
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

    @staticmethod
    def _stack(parts: list[NDArray[np.int32]]) -> NDArray[np.int32]:
        parts = [p for p in parts if len(p)]
        width = max(p.shape[1] for p in parts)
        if len(parts) == 1:
            return parts[0]
        out = np.full((sum(len(p) for p in parts), width), -1, np.int32)
        row = 0
        for p in parts:
            out[row : row + len(p), : p.shape[1]] = p
            row += len(p)
        return out

    @staticmethod
    def _incidence(conn: NDArray[np.int32], nn: int) -> tuple[NDArray, NDArray]:
        flat = conn.ravel()
        keep = flat >= 0
        elem = np.repeat(np.arange(len(conn), dtype=np.int32), conn.shape[1])[keep]
        flat = flat[keep]
        order = np.argsort(flat, kind="stable")
        ptr = np.zeros(nn + 1, np.int64)
        np.cumsum(np.bincount(flat, minlength=nn), out=ptr[1:])
        return ptr, elem[order]

    def _rows(self, first: NDArray, nbr: NDArray, nn: int) -> None:
        size, lead = self.eqs.size, self.lead
        per = size[nbr].astype(np.int64)
        total = np.concatenate([[0], np.cumsum(per)])
        node_len = total[first[1:]] - total[first[:-1]]
        row_node = np.repeat(np.arange(nn), size)
        length = node_len[row_node]
        if self.symmetric:
            length = length - (np.arange(len(row_node)) - lead[row_node])
        indptr = np.concatenate([[0], np.cumsum(length)])
        if indptr[-1] > np.iinfo(np.int32).max:
            raise MemoryError("the tangent has more than 2^31 entries")
        self.indptr = indptr.astype(np.int32)
        self.indices = np.empty(indptr[-1], np.int32)
        kernels.columns(first, nbr, lead, size, self.symmetric, self.indptr, self.indices)
        end = np.repeat(total[first[1:]], np.diff(first))
        self._tail = (end - total[:-1]).astype(np.int32)

    def _offsets(self, group: Group) -> NDArray[np.int32]:
        out = np.empty((group.m, group.n, group.n), np.int32)
        kernels.pair_offsets(self._first, self._nbr, self._tail, group.conn, out)
        return out

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
        return all(kernels.holds(self._first, self._nbr, np.ascontiguousarray(c), self.symmetric) for c in cliques)

    def matrix(self) -> Matrix:
        """A zero matrix of this pattern (the pattern arrays are shared)."""
        return Matrix(self.indptr, self.indices, np.zeros(len(self.indices)), self.symmetric)
