"""What an iterative solver is told of a system: its unknowns, and how much fluid its pores store under pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .fields import DISPLACEMENT, PRESSURE
from .linear.base import LinearError, Unknowns

if TYPE_CHECKING:
    from .group import Chunk, Group
    from .state import State
    from .system import System

Floats = NDArray[np.float64]
LEAST = 0.1  # of a block's median modulus: strained points may be softer, or not stiff at all


def unknowns(system: System) -> Unknowns:
    """The unknowns of a system's matrix rows. Raises LinearError where there are other fields than it knows."""
    strange = [f.name for f in system.layout.fields if f not in (DISPLACEMENT, PRESSURE)]
    if strange:
        raise LinearError(f"the iterative linear solver does not take the field {strange[0]!r}: try --linear pardiso")
    node, column = np.nonzero(system.eqs.numbered)
    rows = system.eqs.rows
    node, column = node[rows], column[rows]
    component = np.full(len(node), -1)
    for k, c in enumerate(system.layout.displacement):
        component[column == c] = k
    return Unknowns(system.state.X, node, component, lambda: storage(system, node[component < 0]))


def storage(system: System, nodes: NDArray[np.int64]) -> Any:
    """int N_a N_b / H dv over the pressures of ``nodes`` (sparse), H the aggregate modulus; zero in steady states."""
    from scipy.sparse import coo_matrix

    n, at = len(nodes), np.full(len(system.state.X), -1)
    at[nodes] = np.arange(n)
    groups = [] if system.steady else [g for g in system.groups if PRESSURE.name in g.fields]
    rows, columns, values = [np.zeros(0, int)], [np.zeros(0, int)], [np.zeros(0)]
    for g in groups:
        w = g.wJ0 * g.J / aggregate(g, system.state)
        M = np.einsum("eg,ga,gb->eab", w, g.N, g.N, optimize=True)
        i, j = (np.broadcast_to(q, M.shape) for q in (at[g.conn][:, :, None], at[g.conn][:, None, :]))
        free = (i >= 0) & (j >= 0)
        for part, q in ((rows, i), (columns, j), (values, M)):
            part.append(q[free])
    triplets = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return coo_matrix(triplets, shape=(n, n)).tocsr()


def aggregate(g: Group, state: State) -> Floats:
    """Mean of the three uniaxial moduli (m, g) of a block at the present state."""
    H = np.concatenate([_moduli(g, c, state) for c in g.chunks]).reshape(g.m, g.g)
    return np.maximum(H, np.maximum(LEAST * np.median(H), 1e-300))


def _moduli(g: Group, c: Chunk, state: State) -> Floats:
    pts, n = c.points, (c.hi - c.lo) * g.g
    s, C = np.zeros((n, 6)), np.zeros((n, 6, 6))
    pts.t, pts.dt = state.time, state.dt
    g.physics.moduli(c, s, C)
    return C[:, range(3), range(3)].mean(axis=1)
