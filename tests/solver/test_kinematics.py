"""Deformation gradients keep their digits far from the origin and in thin elements."""

from __future__ import annotations

import numpy as np

from febkit.solver import elements
from febkit.solver.kernels import solid


def test_deformation_gradient_far_from_the_origin() -> None:
    """F = I + H of a cube of 1/1024 at 1024: from positions its error would be about 1e-10."""
    e = elements.get("hex8")
    X = 1024.0 + (e.natural + 1.0) / 2048.0
    H = 1e-3 * np.array([[1.0, 2.0, -1.0], [0.5, -1.0, 3.0], [0.0, 1.0, 2.0]])
    u = (X - 1024.0) @ H.T
    conn = np.arange(8, dtype=np.int32)[None]
    g = len(e.weights)
    iJ0, wJ0, F, J = np.empty((1, g, 3, 3)), np.empty((1, g)), np.empty((1, g, 3, 3)), np.empty((1, g))
    N, w = np.ascontiguousarray(e.dN), np.ascontiguousarray(e.weights)
    assert solid.reference(X, conn, N, w, iJ0, wJ0) == 0
    # the reference Jacobian itself carries 1e-10 of relative error here, which F keeps to the part du/dX
    assert solid.kinematics(0, 1, u, conn, N, iJ0, F, J) == -1
    np.testing.assert_allclose(F[0] - np.eye(3), np.broadcast_to(H, (g, 3, 3)), atol=1e-11)
    np.testing.assert_allclose(J[0], np.linalg.det(np.eye(3) + H), rtol=1e-11)
