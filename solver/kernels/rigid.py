"""Element matrices of nodes that a rigid body carries, condensed onto its unknowns."""

from __future__ import annotations

import numpy as np

from ..jit import kernel


@kernel
def _share(node, column, owner, eq, z, rows, weights):
    """Unknowns that an unknown of a node stands for, and their weights; returns 1 where a body carries the node.

    du = dt + dtheta x z, so that x is t_x + theta_y z_z - theta_z z_y and so on; a force counts in the same way.
    """
    rows[1] = rows[2] = -1
    weights[0] = 1.0
    b = owner[node]
    if b < 0 or column > 2:
        rows[0] = eq[node, column]
        return 0
    j, k = (column + 1) % 3, (column + 2) % 3
    rows[0] = eq[b, column]
    rows[1] = eq[b + 1, j]
    weights[1] = z[node, k]
    rows[2] = eq[b + 1, k]
    weights[2] = -z[node, j]
    return 1


@kernel
def scatter(K, nodes, columns, owner, eq, zf, zu, free, indptr, indices, data, step, Fd, upper):
    """Add those entries of matrices K (m, d, d) that a body has a part in; the others are added as ever.

    nodes (m, d), columns (d,): the unknown of each row; owner (node,): row of the body that carries a node or -1;
    zf, zu (node, 3): arms of forces and of displacements; Fd (equation): minus prescribed columns times ``step``.
    """
    d = K.shape[1]
    re, ce = np.empty((d, 3), np.int32), np.empty((d, 3), np.int32)
    rw, cw = np.empty((d, 3)), np.empty((d, 3))
    carried = np.empty(d, np.int32)
    for e in range(K.shape[0]):
        for i in range(d):
            carried[i] = _share(nodes[e, i], columns[i], owner, eq, zf, re[i], rw[i])
            _share(nodes[e, i], columns[i], owner, eq, zu, ce[i], cw[i])
        for i in range(d):
            for j in range(d):
                if carried[i] == 0 and carried[j] == 0:
                    continue
                for p in range(3):
                    qr = re[i, p]
                    if qr < 0 or free[qr] < 0:
                        continue
                    r = free[qr]
                    for q in range(3):
                        qc = ce[j, q]
                        if qc < 0:
                            continue
                        v, c = K[e, i, j] * rw[i, p] * cw[j, q], free[qc]
                        if c < 0:
                            Fd[qr] -= v * step[qc]
                            continue
                        if upper and c < r:
                            continue
                        lo, hi = indptr[r], indptr[r + 1]
                        while lo < hi:
                            mid = (lo + hi) >> 1
                            if indices[mid] < c:
                                lo = mid + 1
                            else:
                                hi = mid
                        data[lo] += v
