"""Element matrices of unknowns that depend on others, condensed onto their masters."""

from __future__ import annotations

from ..jit import kernel
from .pattern import enter


@kernel
def scatter(K, nodes, columns, ptr, master, wf, wu, eq, width, free, indptr, indices, data, step, Fd, upper):
    """Add those entries of matrices K (m, d, d) that a tied unknown has a part in; the others are added as ever.

    nodes (m, d), columns (d,): the unknown of each row; ptr, master: compressed rows of masters over flat unknowns
    (node x width + column); wf, wu: weights of forces and of displacements; eq: equation of a flat unknown or -1;
    Fd (equation): minus prescribed columns times ``step``.
    """
    d = K.shape[1]
    for e in range(K.shape[0]):
        for i in range(d):
            di = nodes[e, i] * width + columns[i]
            ni = ptr[di + 1] - ptr[di]
            for j in range(d):
                dj = nodes[e, j] * width + columns[j]
                nj = ptr[dj + 1] - ptr[dj]
                if ni == 0 and nj == 0:
                    continue
                for p in range(max(ni, 1)):
                    v, qr = K[e, i, j], eq[di]
                    if ni > 0:
                        qr = eq[master[ptr[di] + p]]
                        v *= wf[ptr[di] + p]
                    if qr < 0 or free[qr] < 0:
                        continue
                    r = free[qr]
                    for q in range(max(nj, 1)):
                        x, qc = v, eq[dj]
                        if nj > 0:
                            qc = eq[master[ptr[dj] + q]]
                            x *= wu[ptr[dj] + q]
                        if qc < 0:
                            continue
                        c = free[qc]
                        if c < 0:
                            Fd[qr] -= x * step[qc]
                            continue
                        enter(indptr, indices, data, r, c, x, upper)
