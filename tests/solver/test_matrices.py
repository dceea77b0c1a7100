"""Stacks of 3 x 3 matrices against LAPACK's answers."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.matrices import det, eigh, eigvalsh, inv


@pytest.mark.parametrize("shape", [(1,), (17,), (4, 5), (0,), ()])
def test_as_lapack(shape: tuple[int, ...]) -> None:
    A = np.random.default_rng(1).normal(size=(*shape, 3, 3)) + 2.0 * np.eye(3)
    np.testing.assert_allclose(det(A), np.linalg.det(A), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(inv(A), np.linalg.inv(A), rtol=1e-9, atol=1e-12)
    S = A + np.swapaxes(A, -1, -2)
    w, V = eigh(S)
    np.testing.assert_allclose(w, np.linalg.eigvalsh(S), rtol=1e-12, atol=1e-13)
    np.testing.assert_array_equal(eigvalsh(S), w)
    np.testing.assert_allclose((V * w[..., None, :]) @ np.swapaxes(V, -1, -2), S, atol=1e-13)


def test_views_and_other_orders_in_memory() -> None:
    A = np.random.default_rng(2).normal(size=(6, 3, 3)) + 3.0 * np.eye(3)
    for view in (A[::2], np.swapaxes(A, -1, -2), np.asfortranarray(A)):
        np.testing.assert_allclose(inv(view), np.linalg.inv(view), rtol=1e-10)
        np.testing.assert_allclose(det(view), np.linalg.det(view), rtol=1e-12)


@pytest.mark.parametrize("w", [(1, 1, 1), (2, 1, 1), (1, 1, 2), (1, 2, 1), (2, 2, 1), (2, 1, 2), (3, 2, 1), (0, 0, 0)])
def test_equal_eigenvalues_are_ordered(w: tuple[float, ...]) -> None:
    values, vectors = eigh(np.diag(np.array(w, float))[None])
    np.testing.assert_array_equal(values[0], np.sort(w))
    np.testing.assert_allclose(vectors[0] @ vectors[0].T, np.eye(3), atol=1e-15)


def test_a_singular_matrix_has_no_finite_inverse() -> None:
    assert not np.isfinite(inv(np.ones((1, 3, 3)))).any()
