"""Bonds seen from the states in which they were born."""

from __future__ import annotations

import numpy as np

from febkit.solver.kernels.generations import since_birth


def test_deformation_since_birth() -> None:
    """F U^-1 and J / Jb by numpy's inverse; the reference state for the first and for those not yet born."""
    rng = np.random.default_rng(4)
    n, capacity = 3, 5
    F = np.eye(3) + 0.2 * rng.normal(size=(n, 3, 3))
    U = np.eye(3) + 0.1 * rng.normal(size=(n, capacity, 3, 3))
    U = 0.5 * (U + np.swapaxes(U, -1, -2))
    gen = np.zeros((n, capacity, 8))
    gen[:, :, 1] = rng.uniform(0.8, 1.2, (n, capacity))
    gen[:, :, 2:] = U[:, :, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
    count, used = np.array([5.0, 3.0, 0.0]), np.array([0, 2, 3, 4])
    Fg, Jg, Jb = np.empty((n * 4, 3, 3)), np.empty(n * 4), np.empty((n, 4))
    J = np.linalg.det(F)
    since_birth(F, J, gen, count, used, 1, 2, Fg, Jg, Jb)
    for i in range(n):
        for k, g in enumerate(used):
            born = 0 < g < count[i]
            Ui, Ji = (U[i, g - 1], gen[i, g - 1, 1]) if born else (np.eye(3), 1.0)
            np.testing.assert_allclose(Fg[4 * i + k], F[i] @ np.linalg.inv(Ui), rtol=1e-12, atol=1e-14)
            assert np.isclose(Jg[4 * i + k], J[i] / Ji) and Jb[i, k] == Ji
