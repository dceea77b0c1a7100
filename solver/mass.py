"""Consistent mass: M_ab = sum_g rho_0 N_a N_b w J_0, the same for the three displacement components."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .group import Group

Floats = NDArray[np.float64]


def elements(group: Group) -> Floats:
    """Element mass matrices (m, n, n) of one group."""
    rho = np.broadcast_to(group.block.solid.density(group.points()), (group.m * group.g,))
    w = group.wJ0 * rho.reshape(group.m, group.g)
    return np.einsum("eg,ga,gb->eab", w, group.N, group.N, optimize=True)


def assemble(groups: list[Group], nodes: int) -> Any:
    """Sparse mass (node, node)."""
    from scipy.sparse import coo_matrix, csr_matrix

    out = csr_matrix((nodes, nodes))
    for g in groups:
        i = np.repeat(g.conn, g.n, axis=1).ravel()
        j = np.tile(g.conn, (1, g.n)).ravel()
        out = out + coo_matrix((elements(g).ravel(), (i, j)), shape=(nodes, nodes)).tocsr()
    return out
