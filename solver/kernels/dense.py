"""Dense LU of small systems. LAPACK's wakes the threads of its BLAS, which costs more than such a factorisation."""

from __future__ import annotations

from ..jit import kernel


@kernel
def lu(A, pivots, first, last):
    """P A = L U in place by rows, with partial pivoting. Returns the smallest |pivot| (0: singular).

    ``first`` and ``last``: columns (n,) of the first entry and behind the last entry of each row of the factors, so
    that a banded matrix costs no more than its band.
    """
    n = A.shape[0]
    for i in range(n):
        first[i], last[i] = i, i + 1
        for j in range(i):
            if A[i, j] != 0.0:
                first[i] = j
                break
        for j in range(n - 1, i, -1):
            if A[i, j] != 0.0:
                last[i] = j + 1
                break
    least = 1e300
    for k in range(n):
        p, most = k, abs(A[k, k])
        for i in range(k + 1, n):
            if abs(A[i, k]) > most:
                p, most = i, abs(A[i, k])
        pivots[k] = p
        if p != k:
            for j in range(n):
                A[k, j], A[p, j] = A[p, j], A[k, j]
            first[k], first[p] = first[p], first[k]
            last[k], last[p] = last[p], last[k]
        if not most >= least:
            least = most
        if most == 0.0:
            return 0.0
        pivot, row, end = 1.0 / A[k, k], A[k], last[k]
        for i in range(k + 1, n):
            l = A[i, k]
            if l != 0.0:
                l *= pivot
                other = A[i]
                other[k] = l
                for j in range(k + 1, end):
                    other[j] -= l * row[j]
                if end > last[i]:
                    last[i] = end
    return least


@kernel
def lu_solve(A, pivots, first, last, x):
    """x <- A^-1 x with the factors of :func:`lu`."""
    n = A.shape[0]
    for k in range(n):
        p = pivots[k]
        x[k], x[p] = x[p], x[k]
    for i in range(n):
        t = x[i]
        for j in range(first[i], i):
            t -= A[i, j] * x[j]
        x[i] = t
    for i in range(n - 1, -1, -1):
        t = x[i]
        for j in range(i + 1, last[i]):
            t -= A[i, j] * x[j]
        x[i] = t / A[i, i]
