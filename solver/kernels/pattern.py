"""Sparsity of the tangent and scatter of element matrices into compressed rows.

Equations are numbered node by node, so the columns that a node pair (a, b) owns in a row of a are
contiguous. For each element and pair ``back[e, a, b]`` is the distance from the end of a row of node a
to the first column of node b; one number serves all rows of a, in full and in upper storage alike.
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel


@kernel
def _sort(row, n):
    """Sort row[:n] in place: insertion over gaps (Shell 1959). numpy's sort would need numba's lists."""
    gap = 1
    while 3 * gap + 1 < n:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, n):
            x, j = row[i], i
            while j >= gap and row[j - gap] > x:
                row[j] = row[j - gap]
                j -= gap
            row[j] = x
        gap //= 3


@kernel
def node_graph(ptr, elements, conn, upper, first, count, out):
    """Sorted neighbours of each node (itself included; only later ones if ``upper``).

    ptr, elements: CSR of node -> elements; conn (m, n) padded with -1; ``first`` (nodes + 1) is filled
    with offsets when ``count``, else ``out`` with the neighbours.
    """
    nn = ptr.shape[0] - 1
    mark = np.full(nn, -1, np.int32)
    row = np.empty(4096, np.int32)
    for a in range(nn):
        k = 0
        for q in range(ptr[a], ptr[a + 1]):
            e = elements[q]
            for j in range(conn.shape[1]):
                b = conn[e, j]
                if b < 0 or mark[b] == a or (upper and b < a):
                    continue
                mark[b] = a
                if k == row.shape[0]:
                    grown = np.empty(2 * k, np.int32)
                    grown[:k] = row
                    row = grown
                row[k] = b
                k += 1
        if count:
            first[a + 1] = first[a] + k
        else:
            _sort(row, k)
            out[first[a] : first[a] + k] = row[:k]


@kernel
def columns(first, nbr, lead, size, upper, indptr, indices):
    """Column indices of all rows: node a has matrix rows lead[a] : lead[a] + size[a]."""
    for a in range(first.shape[0] - 1):
        for r in range(size[a]):
            q = indptr[lead[a] + r]
            for k in range(first[a], first[a + 1]):
                b = nbr[k]
                for j in range(r if upper and b == a else 0, size[b]):
                    indices[q] = lead[b] + j
                    q += 1


@kernel
def pair_offsets(first, nbr, tail, conn, back):
    """back[e, a, b] (int32) by binary search of b among the neighbours of a; -1 where not stored.

    ``tail[k]``: columns from the start of neighbour k's columns to the row end.
    """
    for e in range(conn.shape[0]):
        for i in range(conn.shape[1]):
            a = conn[e, i]
            for j in range(conn.shape[1]):
                b = conn[e, j]
                back[e, i, j] = -1
                if a < 0 or b < 0:
                    continue
                lo, hi = first[a], first[a + 1]
                while lo < hi:
                    mid = (lo + hi) >> 1
                    if nbr[mid] < b:
                        lo = mid + 1
                    else:
                        hi = mid
                if lo < first[a + 1] and nbr[lo] == b:
                    back[e, i, j] = tail[lo]


@kernel
def scatter(lo, hi, K, conn, back, eq, free, lead, indptr, data, step, Fd, upper):
    """Add element matrices K (hi - lo, c n, c n), component-major, of elements lo:hi.

    eq (node, c): equation (or -1); free (equation): row in the matrix, or -1 where prescribed;
    step (equation): increments of prescribed values, whose columns go to the right side Fd.
    """
    n = conn.shape[1]
    nc = K.shape[1] // n
    for e in range(lo, hi):
        M = K[e - lo]
        for a in range(n):
            na = conn[e, a]
            for i in range(nc):
                qr = eq[na, i]
                if qr < 0:
                    continue
                r = free[qr]
                if r < 0:
                    continue
                row = M[i * n + a]
                end = indptr[r + 1]
                for b in range(n):
                    nb = conn[e, b]
                    base = end - back[e, a, b] - lead[nb]
                    for j in range(nc):
                        qc = eq[nb, j]
                        if qc < 0:
                            continue
                        c = free[qc]
                        if c < 0:
                            Fd[qr] -= row[j * n + b] * step[qc]
                        elif c >= r or not upper:
                            data[base + c] += row[j * n + b]


@kernel
def scatter_any(K, dofs, free, indptr, indices, data, step, Fd, upper):
    """Add matrices K (m, d, d) with equations dofs (m, d; -1 for none) by search in the rows."""
    for e in range(K.shape[0]):
        for i in range(K.shape[1]):
            qr = dofs[e, i]
            if qr < 0:
                continue
            r = free[qr]
            if r < 0:
                continue
            for j in range(K.shape[2]):
                qc = dofs[e, j]
                if qc < 0:
                    continue
                c = free[qc]
                if c < 0:
                    Fd[qr] -= K[e, i, j] * step[qc]
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
                data[lo] += K[e, i, j]
