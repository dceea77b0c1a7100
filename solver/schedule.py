"""Who computes which elements: chunks of all groups dealt out to the threads of a team."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .record import variable_record
from .threads import Team

if TYPE_CHECKING:
    from .group import Chunk, Group

MOST = 256  # elements of a chunk: its points' strains, stresses and tangents stay in the cache
LEAST = 256  # elements that are worth a second thread
FEWEST = 64  # elements of a chunk where there are threads to share them


@variable_record
class Share:
    """What one thread does: chunks of elements, group by group."""

    thread: int
    chunks: list[tuple[Group, Chunk]] = field(default_factory=list)

    @cached_property
    def spans(self) -> list[tuple[Group, int, int]]:
        """(group, first element, one past the last) of the share, group by group; chunks no longer change."""
        out: list[tuple[Group, int, int]] = []
        for g, c in self.chunks:
            if out and out[-1][0] is g and out[-1][2] == c.lo:
                out[-1] = (g, out[-1][1], c.hi)
            else:
                out.append((g, c.lo, c.hi))
        return out


def chunk_size(elements: int, threads: int) -> int:
    """Elements of a chunk, so that every thread has several of them and none is too large for the cache."""
    if elements < 2 * LEAST:  # one thread's work
        return MOST
    return max(min(MOST, -(-elements // (2 * threads))), FEWEST)


class Schedule:
    """Contiguous shares of about equal cost, one for a thread; neighbours mostly share a thread."""

    def __init__(self, groups: list[Group], team: Team) -> None:
        self.team = team
        pairs = [(g, c) for g in groups for c in g.chunks]
        cost = np.array([(c.hi - c.lo) * g.g * g.n * len(g.columns) for g, c in pairs], float)
        elements = sum(c.hi - c.lo for _, c in pairs)
        n = max(1, min(team.n, elements // LEAST, len(pairs)))
        middle = np.cumsum(cost) - 0.5 * cost
        owner = np.minimum((middle / max(cost.sum(), 1.0) * n).astype(int), n - 1)
        shares = [Share(i) for i in range(n)]
        for pair, i in zip(pairs, owner):
            shares[i].chunks.append(pair)
        self.shares = [s for s in shares if s.chunks] or shares[:1]  # rigid bodies alone: a share of nothing
        self.n = len(self.shares)

    def map(self, work: Callable[[Share], object]) -> None:
        """Have every thread do ``work`` on its share; the failure of the earliest elements is raised."""
        if self.n == 1:
            work(self.shares[0])
        else:
            self.team.map(lambda i: work(self.shares[i]), self.n)

    def contended(self, groups: list[Group], nodes: int) -> dict[int, NDArray[np.bool_]]:
        """For each group (by id) the elements with a node that elements of another thread have too."""
        seen = np.zeros(nodes, np.int16)
        for s in self.shares:
            mine = np.zeros(nodes, bool)
            for g, c in s.chunks:
                mine[g.conn[c.lo : c.hi]] = True
            seen += mine
        return {id(g): np.asarray((seen[g.conn] > 1).any(axis=1)) for g in groups}
