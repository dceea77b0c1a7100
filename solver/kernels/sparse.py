"""Products with compressed rows."""

from __future__ import annotations

from ..jit import kernel


@kernel
def multiply(indptr, indices, data, symmetric, x, y):
    """y += A x; ``symmetric``: only the upper triangle is stored."""
    for i in range(indptr.shape[0] - 1):
        xi = x[i]
        s = 0.0
        for q in range(indptr[i], indptr[i + 1]):
            j = indices[q]
            s += data[q] * x[j]
            if symmetric and j != i:
                y[j] += data[q] * xi
        y[i] += s
