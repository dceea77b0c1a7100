"""Dense LU of small systems. LAPACK's wakes the threads of its BLAS, which costs more than such a factorisation."""

from __future__ import annotations

from ..jit import kernel


@kernel
def lu(A, pivots):
    """P A = L U in place by rows, with partial pivoting. Returns the smallest |pivot| (A is equilibrated).

    Rows that the pivot's column does not reach are left alone, so that profiles of sparse matrices stay cheap.
    """
    n = A.shape[0]
    least = 1.0
    for k in range(n):
        p, most = k, abs(A[k, k])
        for i in range(k + 1, n):
            if abs(A[i, k]) > most:
                p, most = i, abs(A[i, k])
        pivots[k] = p
        if p != k:
            for j in range(n):
                A[k, j], A[p, j] = A[p, j], A[k, j]
        if not most >= least:
            least = most
        if most == 0.0:
            return 0.0
        pivot = 1.0 / A[k, k]
        row = A[k]
        for i in range(k + 1, n):
            l = A[i, k]
            if l != 0.0:
                l *= pivot
                other = A[i]
                other[k] = l
                for j in range(k + 1, n):
                    other[j] -= l * row[j]
    return least


@kernel
def lu_solve(A, pivots, x):
    """x <- A^-1 x with the factors of :func:`lu`."""
    n = A.shape[0]
    for k in range(n):
        p = pivots[k]
        x[k], x[p] = x[p], x[k]
    for i in range(n):
        t = x[i]
        for j in range(i):
            t -= A[i, j] * x[j]
        x[i] = t
    for i in range(n - 1, -1, -1):
        t = x[i]
        for j in range(i + 1, n):
            t -= A[i, j] * x[j]
        x[i] = t / A[i, i]
