"""Which rows of the tangent meet which: what depends on the mesh and on which unknowns are free, and on no value."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import blake2b
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .kernels import pattern as kernels

Ints = NDArray[np.int32]
MOST = 8  # graphs that are kept: of the steps of a model, and of contacts on their way
ROOM = 2**28  # bytes that they may take together; what takes more is not kept (300,000 unknowns and more)


class Graph:
    """Compressed rows for node cliques ``parts`` (m, n), padded with -1, where nodes have ``size`` (node,) rows each.

    kept: what linear solvers found of the rows (:class:`.linear.base.Matrix`); None where no later run is to have it.
    """

    def __init__(self, parts: list[Ints], size: Ints, symmetric: bool) -> None:
        nn, conn = len(size), stack(parts)
        self.parts, self.symmetric = parts, symmetric
        self.kept: dict[Any, list[Any]] | None = None
        ptr, elems = _incidence(conn, nn)
        first = np.zeros(nn + 1, np.int64)
        kernels.node_graph(ptr, elems, conn, symmetric, first, True, np.empty(0, np.int32))
        nbr = np.empty(first[-1], np.int32)
        kernels.node_graph(ptr, elems, conn, symmetric, first, False, nbr)
        self._first, self._nbr = first, nbr
        self._rows(size)
        self._back: dict[int, Ints] = {}

    def _rows(self, size: Ints) -> None:
        first, nbr = self._first, self._nbr
        lead = np.zeros(len(size), np.int32)
        lead[1:] = np.cumsum(size)[:-1]
        total = np.concatenate([[0], np.cumsum(size[nbr].astype(np.int64))])
        node_len = total[first[1:]] - total[first[:-1]]
        row_node = np.repeat(np.arange(len(size)), size)
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

    def back(self, part: int) -> Ints:
        """(m, n, n) offsets of a part's node pairs from the row ends."""
        if part not in self._back:
            conn = self.parts[part]
            out = np.empty((*conn.shape, conn.shape[1]), np.int32)
            kernels.pair_offsets(self._first, self._nbr, self._tail, conn, out)
            self._back[part] = out
        return self._back[part]

    def holds(self, clique: NDArray[np.int32]) -> bool:
        """Is there an entry for every pair of nodes of the cliques (m, n)?"""
        return bool(kernels.holds(self._first, self._nbr, np.ascontiguousarray(clique), self.symmetric))

    @property
    def nbytes(self) -> int:
        own = [*self.parts, self._first, self._nbr, self._tail, self.indptr, self.indices, *self._back.values()]
        return sum(a.nbytes for a in own)


MakeGraph = Callable[[list[Ints], Ints, bool], Graph]


class Graphs:
    """Graphs by what they were made of, for runs one after the other: a second one of the same mesh finds its own."""

    def __init__(self) -> None:
        self._held: dict[bytes, Graph] = {}

    def __call__(self, parts: list[Ints], size: Ints, symmetric: bool) -> Graph:
        key = _digest([np.array([symmetric]), size, *parts])
        found = self._held.pop(key, None)
        if found is None:
            found = Graph([p.copy() for p in parts], size, symmetric)
            if found.nbytes > ROOM:
                return found
            found.kept = {}
        self._held[key] = found
        while len(self._held) > MOST or sum(g.nbytes for g in self._held.values()) > ROOM:
            del self._held[next(iter(self._held))]
        return found


def _digest(arrays: list[NDArray]) -> bytes:
    out = blake2b(digest_size=16)
    for a in arrays:
        out.update(repr((a.shape, a.dtype.str)).encode())
        out.update(a.tobytes())
    return out.digest()


def stack(parts: list[Ints]) -> Ints:
    """Cliques one below the other, padded with -1."""
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


def _incidence(conn: Ints, nn: int) -> tuple[NDArray, NDArray]:
    flat = conn.ravel()
    keep = flat >= 0
    elem = np.repeat(np.arange(len(conn), dtype=np.int32), conn.shape[1])[keep]
    flat = flat[keep]
    order = np.argsort(flat, kind="stable")
    ptr = np.zeros(nn + 1, np.int64)
    np.cumsum(np.bincount(flat, minlength=nn), out=ptr[1:])
    return ptr, elem[order]
