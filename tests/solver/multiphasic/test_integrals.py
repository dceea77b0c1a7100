"""Element matrices and forces against sums written out."""

from __future__ import annotations

import numpy as np

from febkit.solver.multiphasic.integrals import at_points, forces, matrices

RNG = np.random.default_rng(1)
E, G, N, C = 3, 4, 5, 6
B, W = RNG.uniform(-1, 1, (E, G, 4, N)), RNG.uniform(0.5, 1, (E, G))


def test_matrices() -> None:
    A = RNG.uniform(-1, 1, (E * G, 4, C, C, 4))
    A[:, 0, :3], A[:, :, :, :3, 0] = 0.0, 0.0
    sums = np.einsum("eg,egai,egarsb,egbj->erisj", W, B, A.reshape(E, G, 4, C, C, 4), B)
    assert np.allclose(matrices(B, W, A), sums.reshape(E, C * N, C * N), atol=1e-13)


def test_forces_and_values() -> None:
    stress = RNG.uniform(-1, 1, (E * G, 4, C))
    sums = np.einsum("eg,egai,egar->eri", W, B, stress.reshape(E, G, 4, C))
    assert np.allclose(forces(B, W, stress), sums, atol=1e-13)
    nodal = RNG.uniform(-1, 1, (E, N, 2))
    values = np.einsum("egai,eik->egak", B, nodal).reshape(E * G, 4, 2)
    assert np.allclose(at_points(B, nodal), values, atol=1e-13)
