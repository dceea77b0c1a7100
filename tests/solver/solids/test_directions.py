"""Directions of a sphere along principal axes of strain: signs, order, rotation."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.kernels.ordered_spectra import ordered_spectra
from febkit.solver.solids.continuous_fibers import turned
from febkit.solver.solids.schemes import Kronrod

# FEBio 4.11's own axes (mat3ds::eigen2; columns) of strains xx yy zz xy yz xz
PRINTED = [
    (
        [-0.73, -0.468, -0.7, -0.997, 0.518, 0.561],
        [-0.6505365361559932, -0.5758918118790858, 0.4951270908936268,
         -0.3887518165216842, -0.307554035284073, -0.8684944101901718,
         -0.6524371542740748, 0.7574689012699511, 0.0238038511934597],
    ),  # fmt: skip
    (
        [0.263, 0.399, 0.852, 0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0,
         0.0, 1.0, 0.0,
         0.0, 0.0, 1.0],
    ),  # fmt: skip
    (
        [-0.838, 0.735, -0.441, -0.181, 0.0, 0.0],
        [-0.9936112818193542, -0.1128566375597813, 0.0,
         0.0, 0.0, 1.0,
         -0.1128566375597813, 0.9936112818193542, 0.0],
    ),  # fmt: skip
    (
        [0.465, 0.465, 0.303, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0,
         0.0, 1.0, 0.0,
         1.0, 0.0, 0.0],
    ),  # fmt: skip
    (
        [-0.471, 0.637, 0.829, 4.93e-18, -5.5500000000000005e-18, -5.76e-18],
        [1.0, 1e-16, -0.0,
         -1e-16, -1.0000000000000002, 0.0,
         0.0, 0.0, 1.0],
    ),  # fmt: skip
    (
        [0.1, 0.1, 0.1, 1e-17, -2e-17, 0.0],
        [-1.0, 0.0, 0.0,
         0.0, -1.0, 0.0,
         0.0, 0.0, 1.0],
    ),  # fmt: skip
]


def _matrix(a: np.ndarray) -> np.ndarray:
    return np.array([[a[0], a[3], a[5]], [a[3], a[1], a[4]], [a[5], a[4], a[2]]])


@pytest.mark.parametrize(("strain", "axes"), PRINTED)
def test_axes_have_febios_signs(strain: list[float], axes: list[float]) -> None:
    A = _matrix(np.array(strain))[None]
    w, V = np.empty((1, 3)), np.empty((1, 3, 3))
    ordered_spectra(A, w, V)
    np.testing.assert_allclose(V[0], np.array(axes).reshape(3, 3).T, atol=1e-14)
    np.testing.assert_allclose(A[0] @ V[0], V[0] * w[0], atol=1e-14)


def test_axes_of_random_strains() -> None:
    rng = np.random.default_rng(2)
    A = rng.normal(size=(200, 3, 3))
    A = A + np.swapaxes(A, 1, 2)
    w, V = np.empty((200, 3)), np.empty((200, 3, 3))
    ordered_spectra(A, w, V)
    np.testing.assert_allclose(w, np.linalg.eigvalsh(A), atol=1e-13)
    np.testing.assert_allclose(np.swapaxes(V, 1, 2) @ V, np.broadcast_to(np.eye(3), V.shape), atol=1e-13)


def test_all_directions_count_at_rest() -> None:
    """The first tangent of a fibrous solid has the stiffness of its fibers; compression takes it away."""
    N, w = Kronrod(nph=11, nth=31).taut(np.eye(3)[None])
    assert w.sum() == pytest.approx(4 * np.pi)
    np.testing.assert_allclose(np.linalg.norm(N[0], axis=1), 1.0)
    _, none = Kronrod(nph=11, nth=31).taut(0.9 * np.eye(3)[None])
    assert none.sum() == 0.0


def test_turned() -> None:
    rng = np.random.default_rng(5)
    N, Q = rng.normal(size=(4, 7, 3)), np.linalg.qr(rng.normal(size=(4, 3, 3)))[0]
    np.testing.assert_allclose(turned(N, Q), N @ np.swapaxes(Q, 1, 2), atol=1e-14)
    np.testing.assert_allclose(turned(N[:1], Q), N[:1] @ np.swapaxes(Q, 1, 2), atol=1e-14)
