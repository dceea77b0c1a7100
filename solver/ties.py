"""Unknowns that depend on others: du = sum of weight x du of masters, so that forces go to the masters by weight.

Carried nodes of rigid bodies and linear constraints are such. They have no equations; what elements and loads add at
them is condensed onto their masters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .kernels import ties as kernels
from .values import Constant, Value, as_value

if TYPE_CHECKING:
    from .fields import Layout
    from .linear.base import Matrix
    from .pattern import Equations
    from .state import State

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Source(Protocol):
    """Unknowns are flat indices into nodal arrays (node, column)."""

    def tied(self, layout: Layout) -> tuple[Ints, Ints, Ints]:
        """Tied unknowns (k,), how many masters each has (k,), and the masters one after another."""
        ...

    def weights(self, s: State, alpha: float) -> Floats:
        """Weights of the masters at a time between the last step (alpha 0) and the present (1)."""
        ...


@dataclass(eq=False)
class LinearConstraint:
    """u of (node, column) = offset + sum of values x u of (nodes, columns). FEBio user manual, "Linear constraints"."""

    node: int
    column: int
    nodes: Ints
    columns: Ints
    values: tuple[Value | float, ...]
    offset: float = 0.0


class Constraints:
    """The linear constraints of a step at work."""

    def __init__(self, records: list[LinearConstraint], layout: Layout) -> None:
        own = np.array([c.node * layout.width + c.column for c in records])
        masters = np.concatenate([c.nodes * layout.width + c.columns for c in records])
        self._tied = own, np.array([len(c.nodes) for c in records]), masters
        self._offsets = np.array([c.offset for c in records])
        values = [as_value(v) for c in records for v in c.values]
        self._weights = np.array([v.number if isinstance(v, Constant) else 0.0 for v in values])
        self._vary = [(k, v) for k, v in enumerate(values) if not isinstance(v, Constant)]

    def tied(self, layout: Layout) -> tuple[Ints, Ints, Ints]:
        return self._tied

    def weights(self, s: State, alpha: float) -> Floats:
        for k, v in self._vary:
            self._weights[k] = v(s.time, s.X[:1])[0]
        return self._weights

    def enforce(self, s: State) -> None:
        """Move the tied unknowns."""
        own, count, masters = self._tied
        d = s.d.reshape(-1)
        first = np.concatenate([[0], np.cumsum(count)[:-1]])
        d[own] = np.add.reduceat(self.weights(s, 1.0) * d[masters], first) + self._offsets


class Ties:
    """All ties of an analysis step, as compressed rows over the unknowns."""

    def __init__(self, sources: Sequence[Source], state: State) -> None:
        shape = state.d.shape
        self.sources, self.columns = sources, shape[1]
        parts = [q.tied(state.layout) for q in sources]
        self.own, count, masters = (np.concatenate([p[k] for p in parts]) for k in range(3))
        order = np.argsort(self.own, kind="stable")
        start = np.concatenate([[0], np.cumsum(count)])
        self._entry = np.concatenate([np.zeros(0, int), *(np.arange(start[i], start[i + 1]) for i in order)])
        self.ptr = np.zeros(shape[0] * shape[1] + 1, np.int64)
        self.ptr[1:] = np.cumsum(np.bincount(self.own.astype(int), count, len(self.ptr) - 1))
        self.master = masters[self._entry].astype(np.int32)
        self.slave = np.repeat(self.own[order], count[order])
        self.touched = np.zeros(shape[0], bool)
        self.touched[self.own // shape[1]] = True
        self._partners(shape[0])
        self.wu = self.wf = np.zeros(len(self.master))

    def _partners(self, nodes: int) -> None:
        """Nodes of the masters of each node that has any, padded with -1."""
        pairs = np.unique(np.stack([self.slave // self.columns, self.master // self.columns], axis=1), axis=0)
        node, first, count = np.unique(pairs[:, 0], return_index=True, return_counts=True)
        self._at = np.full(nodes, len(node))
        self._at[node] = np.arange(len(node))
        self._of = np.full((len(node) + 1, int(count.max(initial=0))), -1)
        rank = np.arange(len(pairs)) - np.repeat(first, count)
        self._of[self._at[pairs[:, 0]], rank] = pairs[:, 1]

    # ---- sparsity ---------------------------------------------------------------------------------
    def rows(self, conn: Any) -> Ints:
        """Rows of a node list (m, n) with a tied node."""
        return np.flatnonzero((self.touched[conn] & (np.asarray(conn) >= 0)).any(axis=1))

    def cliques(self, conns: list[NDArray[np.int32]]) -> list[NDArray[np.int32]]:
        """For rows of node lists that touch ties, their nodes with the masters'."""
        out = []
        for conn in conns:
            some = conn[self.rows(conn)]
            if not len(some):
                continue
            other = self._of[np.where(some >= 0, self._at[some], -1)].reshape(len(some), -1)
            other = -np.sort(-other, axis=1)
            other[:, 1:][other[:, 1:] == other[:, :-1]] = -1
            other = -np.sort(-other, axis=1)
            most = int((other >= 0).sum(axis=1).max())
            out.append(np.hstack([some, other[:, :most]]).astype(np.int32))
        return out

    # ---- at work ----------------------------------------------------------------------------------
    def aim(self, s: State, alpha: float) -> None:
        """Take the weights of the present state: of displacements now, of forces between the steps."""
        self.wu = np.concatenate([q.weights(s, 1.0) for q in self.sources])[self._entry]
        self.wf = self.wu
        if alpha != 1.0:
            self.wf = np.concatenate([q.weights(s, alpha) for q in self.sources])[self._entry]

    def gather(self, s: State, R: Floats, alpha: float) -> None:
        """Hand forces R (node, column) on to the masters."""
        w = np.concatenate([q.weights(s, alpha) for q in self.sources])[self._entry]
        flat = R.reshape(-1)
        np.add.at(flat, self.master, w * flat[self.slave])

    def scatter(self, eqs: Equations, A: Matrix, K: Floats, nodes: Any, columns: Any, step: Floats, Fd: Floats) -> None:
        """Add what matrices K (m, d, d) of unknowns (nodes (m, d), columns (d,)) add at the masters."""
        kernels.scatter(
            np.ascontiguousarray(K), np.ascontiguousarray(nodes, np.int32), np.ascontiguousarray(columns, np.int32),
            self.ptr, self.master, self.wf, self.wu, eqs.eq.reshape(-1), self.columns, eqs.free, A.indptr,
            A.indices, A.data, step, Fd, A.symmetric,
        )  # fmt: skip
