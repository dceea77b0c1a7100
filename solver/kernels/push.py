"""Pull back and push forward of stresses, and sums of scaled stresses and tangents."""

from __future__ import annotations

from ..jit import kernel


@kernel
def congruence(A, k, s, out):
    """out[i] = k[i] A[i] s[i] A[i]^T for symmetric s (n, 6) and A (n, 3, 3)."""
    for i in range(len(k)):
        xx, yy, zz, xy, yz, xz = s[i, 0], s[i, 1], s[i, 2], s[i, 3], s[i, 4], s[i, 5]
        for m in range(6):
            p = m if m < 3 else (0 if m != 4 else 1)
            q = m if m < 3 else (1 if m == 3 else 2)
            a, b, c = A[i, p, 0], A[i, p, 1], A[i, p, 2]
            d, e, f = A[i, q, 0], A[i, q, 1], A[i, q, 2]
            out[i, m] = k[i] * (
                a * (xx * d + xy * e + xz * f) + b * (xy * d + yy * e + yz * f) + c * (xz * d + yz * e + zz * f)
            )


@kernel
def add_scaled(k, s, c, s_out, c_out):
    """s_out += k s and c_out += k c, each point with its own k (n,)."""
    for i in range(len(k)):
        for p in range(6):
            s_out[i, p] += k[i] * s[i, p]
        if c_out.shape[0] > 0:
            for p in range(6):
                for q in range(6):
                    c_out[i, p, q] += k[i] * c[i, p, q]
