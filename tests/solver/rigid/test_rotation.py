"""Quaternions against rotation matrices."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.rigid import rotation

RNG = np.random.default_rng(5)


def rodrigues(v: np.ndarray) -> np.ndarray:
    a = np.linalg.norm(v)
    k = rotation.skew(v / a)
    return np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * k @ k


@pytest.mark.parametrize("size", [1e-9, 0.3, 2.5, 5.0])
def test_a_rotation_vector_turns_by_rodrigues_formula(size: float) -> None:
    v = RNG.normal(size=3)
    v *= size / np.linalg.norm(v)
    q = rotation.of_vector(v)
    np.testing.assert_allclose(rotation.matrix(q), rodrigues(v), atol=1e-14)
    np.testing.assert_allclose(rotation.vector(q), v, rtol=1e-9)
    if size < np.pi:
        np.testing.assert_allclose(rotation.cayley(q), 2 * np.tan(size / 2) * v / size, rtol=1e-12)
        np.testing.assert_allclose(rotation.of_cayley(rotation.cayley(q)), q, atol=1e-14)


def test_products_are_compositions() -> None:
    p, q = (rotation.of_vector(RNG.normal(size=3)) for _ in range(2))
    both = rotation.matrix(rotation.product(p, q))
    np.testing.assert_allclose(both, rotation.matrix(p) @ rotation.matrix(q), atol=1e-14)
    back = rotation.product(p, rotation.conjugate(p))
    np.testing.assert_allclose(back, rotation.IDENTITY, atol=1e-15)
    assert not rotation.vector(np.array(rotation.IDENTITY)).any()


def test_euler_angles_turn_about_x_then_y_then_z() -> None:
    x, y, z = 0.4, -0.7, 1.1
    turns = [rodrigues(np.array(v)) for v in ((0, 0, z), (0, y, 0), (x, 0, 0))]
    expected = turns[0] @ turns[1] @ turns[2]
    np.testing.assert_allclose(rotation.matrix(rotation.of_euler(x, y, z)), expected, atol=1e-14)
