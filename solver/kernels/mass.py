"""Products with element mass matrices."""

from __future__ import annotations

from ..jit import kernel


@kernel
def add_product(conn, M, a, out):
    """out (node, 3) += sum over elements of M (m, n, n) applied to nodal vectors a (node, 3)."""
    for e in range(conn.shape[0]):
        for p in range(conn.shape[1]):
            x = y = z = 0.0
            for q in range(conn.shape[1]):
                m, b = M[e, p, q], conn[e, q]
                x += m * a[b, 0]
                y += m * a[b, 1]
                z += m * a[b, 2]
            n = conn[e, p]
            out[n, 0] += x
            out[n, 1] += y
            out[n, 2] += z
