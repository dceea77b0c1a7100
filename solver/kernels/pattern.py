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
    mark = np.empty(nn, np.int32)
    for a in range(nn):
        mark[a] = -1
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
                    for i in range(k):
                        grown[i] = row[i]
                    row = grown
                row[k] = b
                k += 1
        if count:
            first[a + 1] = first[a] + k
        else:
            _sort(row, k)
            for i in range(k):
                out[first[a] + i] = row[i]


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
def holds(first, nbr, conn, upper):
    """Are all pairs of nodes of each row of conn (m, n; -1 for none) neighbours? ``upper``: only later ones are."""
    for e in range(conn.shape[0]):
        for i in range(conn.shape[1]):
            a = conn[e, i]
            for j in range(conn.shape[1]):
                b = conn[e, j]
                if a < 0 or b < 0 or (upper and b < a):
                    continue
                lo, hi = first[a], first[a + 1]
                while lo < hi:
                    mid = (lo + hi) >> 1
                    if nbr[mid] < b:
                        lo = mid + 1
                    else:
                        hi = mid
                if lo == first[a + 1] or nbr[lo] != b:
                    return False
    return True


@kernel
def scatter(lo, hi, K, conn, back, row, given, lead, indptr, data, step, Fd, upper):
    """Add element matrices K (hi - lo, c n, c n), component-major, of elements lo:hi; see :func:`scatter_upper`.

    ``upper``: the mirror image of their lower triangle, which is what FEBio keeps of matrices that are not symmetric.
    """
    n = conn.shape[1]
    nc = K.shape[1] // n
    for e in range(lo, hi):
        M = K[e - lo]
        for a in range(n):
            na = conn[e, a]
            for i in range(nc):
                r = row[na, i]
                if r < 0:
                    continue
                values = M[i * n + a]
                end = indptr[r + 1]
                for b in range(n):
                    nb = conn[e, b]
                    base = end - back[e, a, b] - lead[nb]
                    for j in range(nc):
                        c = row[nb, j]
                        if c >= 0 and not upper:
                            data[base + c] += values[j * n + b]
                        elif c >= r:
                            data[base + c] += M[j * n + b, i * n + a]
                        elif c < 0 and given[nb, j] >= 0:
                            Fd[r] -= values[j * n + b] * step[given[nb, j]]


@kernel
def scatter_upper(lo, hi, some, B, U, conn, back, row, given, lead, size, indptr, data, step, Fd):
    """Add symmetric element blocks (see :mod:`.blocks`) of those elements lo:hi that ``some`` (hi - lo,) marks.

    row (node, c): matrix row of an unknown or -1; given (node, c): equation of a prescribed one or -1; lead (node):
    first row of a node; size (node): c where its unknowns are all free and in a row, else -1; step (equation):
    increments of prescribed values, whose columns go to the right side Fd (row). Storage is upper.
    """
    n = conn.shape[1]
    fluid = U.shape[0] > 0
    nc = 4 if fluid else 3
    k = np.zeros((4, 4))
    for e in range(lo, hi):
        if not some[e - lo]:
            continue
        Be, Ue = B[e - lo], U[e - lo if fluid else 0 : e - lo + 1]
        for i in range(n):
            for j in range(i, n):
                a, b = (i, j) if lead[conn[e, i]] <= lead[conn[e, j]] else (j, i)
                na, nb = conn[e, a], conn[e, b]
                k00, k11, k22 = Be[a, b], Be[3 * n + a, b], Be[5 * n + a, b]
                k01, k10 = Be[n + a, b], Be[n + b, a]
                k02, k20 = Be[2 * n + a, b], Be[2 * n + b, a]
                k12, k21 = Be[4 * n + a, b], Be[4 * n + b, a]
                k03 = k13 = k23 = k30 = k31 = k32 = k33 = 0.0
                if fluid:
                    k03, k13, k23 = Ue[0, a, b], Ue[0, n + a, b], Ue[0, 2 * n + a, b]
                    k30, k31, k32 = Ue[0, b, a], Ue[0, n + b, a], Ue[0, 2 * n + b, a]
                    k33 = Be[6 * n + a, b]
                far = back[e, a, b]
                if a != b and size[na] == nc and size[nb] == nc:  # nearly all: nothing fixed or prescribed
                    R = lead[na]
                    p, q, r = indptr[R + 1] - far, indptr[R + 2] - far, indptr[R + 3] - far
                    data[p] += k00
                    data[p + 1] += k01
                    data[p + 2] += k02
                    data[q] += k10
                    data[q + 1] += k11
                    data[q + 2] += k12
                    data[r] += k20
                    data[r + 1] += k21
                    data[r + 2] += k22
                    if fluid:
                        data[p + 3] += k03
                        data[q + 3] += k13
                        data[r + 3] += k23
                        p = indptr[R + 4] - far
                        data[p] += k30
                        data[p + 1] += k31
                        data[p + 2] += k32
                        data[p + 3] += k33
                    continue
                k[0, 0], k[0, 1], k[0, 2], k[0, 3] = k00, k01, k02, k03
                k[1, 0], k[1, 1], k[1, 2], k[1, 3] = k10, k11, k12, k13
                k[2, 0], k[2, 1], k[2, 2], k[2, 3] = k20, k21, k22, k23
                k[3, 0], k[3, 1], k[3, 2], k[3, 3] = k30, k31, k32, k33
                _add_pair(k, nc, na, nb, far + lead[nb], row, given, indptr, data, step, Fd)


@kernel
def _add_pair(k, nc, na, nb, far, row, given, indptr, data, step, Fd):
    """Add the entries of one node pair, some of whose unknowns may be fixed or prescribed."""
    for r in range(nc):
        R = row[na, r]
        if R >= 0:
            base = indptr[R + 1] - far
            for c in range(r if na == nb else 0, nc):
                if row[nb, c] >= 0:
                    data[base + row[nb, c]] += k[r, c]
            for c in range(nc):
                if given[nb, c] >= 0:
                    Fd[R] -= k[r, c] * step[given[nb, c]]
    if na != nb:
        for c in range(nc):
            R = row[nb, c]
            if R >= 0:
                for r in range(nc):
                    if given[na, r] >= 0:
                        Fd[R] -= k[r, c] * step[given[na, r]]


@kernel
def find(indptr, indices, r, c):
    """Where the stored entry of row r and column c is."""
    lo, hi = indptr[r], indptr[r + 1]
    while lo < hi:
        mid = (lo + hi) >> 1
        if indices[mid] < c:
            lo = mid + 1
        else:
            hi = mid
    return lo


@kernel
def enter(indptr, indices, data, r, c, value, upper):
    """Add a value at row r, column c; above the diagonal it is left out where the storage is ``upper``: see
    :func:`scatter`."""
    if not upper:
        data[find(indptr, indices, r, c)] += value
    elif c <= r:
        data[find(indptr, indices, c, r)] += value


@kernel
def scatter_any(K, dofs, free, indptr, indices, data, step, Fd, upper):
    """Add matrices K (m, d, d) with equations dofs (m, d; -1 for none) by search in the rows; see :func:`scatter`.

    Where a row is not much longer than what is added to it, the places of all of its columns are looked up at once.
    """
    d = K.shape[1]
    place, at = np.zeros(len(indptr) - 1, np.int64), np.empty(d, np.int64)
    for e in range(K.shape[0]):
        for i in range(d):
            at[i] = free[dofs[e, i]] if dofs[e, i] >= 0 else -1
        for i in range(d):
            r = at[i]
            if r < 0:
                continue
            known = indptr[r + 1] - indptr[r] < 8 * d
            if known:
                for q in range(indptr[r], indptr[r + 1]):
                    place[indices[q]] = q
            for j in range(d):
                c = at[j]
                if c < 0:
                    if dofs[e, j] >= 0:
                        Fd[dofs[e, i]] -= K[e, i, j] * step[dofs[e, j]]
                elif upper and c < r:
                    continue
                elif known:
                    data[place[c]] += K[e, j, i] if upper else K[e, i, j]
                else:
                    data[find(indptr, indices, r, c)] += K[e, j, i] if upper else K[e, i, j]


@kernel
def uncouple(indptr, indices, data, held):
    """Leave of the rows and columns that ``held`` marks the diagonal alone, -1 where that is 0."""
    for r in range(len(held)):
        for q in range(indptr[r], indptr[r + 1]):
            c = indices[q]
            if c != r and (held[r] or held[c]):
                data[q] = 0.0
            elif c == r and held[r] and data[q] == 0.0:
                data[q] = -1.0
