"""Element integrals by values and spatial gradients: all fields of a mixture share one set of shape functions.

B (e, g, 4, n): shape functions (0) and their spatial gradients (1..3) at the points of elements lo:hi.
"""

from __future__ import annotations

import numpy as np

from ..kernels import mixture as kernels
from ..law import Floats


def operators(lo: int, hi: int, N: Floats, dN: Floats, iJ0: Floats, F: Floats, J: Floats) -> Floats:
    """B of elements lo:hi at the deformation F (m, g, 3, 3), J (m, g)."""
    B = np.empty((hi - lo, *dN.shape[:1], 4, dN.shape[1]))
    kernels.shapes(lo, hi, N, dN, iJ0, F, J, B)
    return B


def at_points(B: Floats, nodal: Floats) -> Floats:
    """Values and gradients (e g, 4, k) of nodal fields (e, n, k)."""
    out = np.matmul(B, nodal[:, None])
    return out.reshape(-1, 4, nodal.shape[2])


def forces(B: Floats, w: Floats, stress: Floats) -> Floats:
    """Nodal forces (e, C, n): sum over points of w B . stress, for weights w (e, g) and stress (e g, 4, C)."""
    e, g, _, n = B.shape
    weighted = (B * w[..., None, None]).reshape(e, 4 * g, n)
    return np.matmul(stress.reshape(e, 4 * g, -1).transpose(0, 2, 1), weighted)


def matrices(B: Floats, w: Floats, A: Floats) -> Floats:
    """Element matrices (e, C n, C n), component-major: sum over points of w B . A . B, A (e g, 4, C, C, 4).

    The first three components are displacements: what A holds for their values is passed over.
    """
    e, n, C = B.shape[0], B.shape[3], A.shape[2]
    K = np.empty((e, C * n, C * n))
    kernels.matrices(B, w, A, K)
    return K
