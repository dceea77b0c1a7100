"""The way back to a yield surface against differences of what it is the derivative of."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.kernels.return_map import mises, newton, octahedral, parabola_root, place, polar
from febkit.solver.points import Points
from febkit.solver.solids.base import evaluate
from febkit.solver.solids.plastic_flow import Trial
from febkit.solver.solids.registry import load

RANDOM = np.random.default_rng(5)


def near_identity(n: int, size: float = 0.1) -> np.ndarray:
    return np.eye(3) + size * RANDOM.standard_normal((n, 3, 3))


def trial(n: int = 4) -> tuple[Trial, Points]:
    solid = load("solid", "neo-Hookean")(E=2.0, v=0.3)
    pts = Points.at(near_identity(n))
    Us = near_identity(n, 0.02)
    return Trial.start(solid, load("criterion", "DC von Mises stress")(), pts, Us, True), pts


def test_polar_decomposition() -> None:
    F, Us = near_identity(5), near_identity(5, 0.02)
    Fe, R, Ue, Ri = (np.empty((5, 3, 3)) for _ in range(4))
    Je = np.empty(5)
    polar(F, Us, Fe, Je, R, Ue, Ri)
    np.testing.assert_allclose(Fe, F @ Us, atol=1e-14)
    np.testing.assert_allclose(Je, np.linalg.det(F @ Us), atol=1e-14)
    np.testing.assert_allclose(R @ np.swapaxes(R, 1, 2), np.broadcast_to(np.eye(3), R.shape), atol=1e-13)
    np.testing.assert_allclose(Ri @ Ue @ Ue, Fe, atol=1e-13)
    w = np.linalg.eigvalsh(np.swapaxes(R, 1, 2) @ F - F.swapaxes(1, 2) @ R)
    np.testing.assert_allclose(w, 0.0, atol=1e-13)  # R^T F is symmetric


def test_normal_is_the_derivative_of_the_measure() -> None:
    """d measure = size N : dU for symmetric changes of the elastic stretch, at any rotation."""
    t, _ = trial()
    Fe = t.R @ t.Ue
    for dU in (np.diag([1.0, 0.0, 0.0]), np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])):
        K = [t.criterion.of(t.base, Points.at(Fe + h * t.R @ np.broadcast_to(dU, Fe.shape))) for h in (-1e-6, 1e-6)]
        found = (K[1] - K[0]) / 2e-6
        np.testing.assert_allclose(t.size * (t.N * dU).sum((1, 2)), found, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("iso", [0, 1])
def test_newton_divides_by_the_derivative_along_the_normal(iso: int) -> None:
    t, _ = trial()
    lam, phi, out = np.full(4, 0.01), np.full(4, 0.3), np.empty(4)
    eye = np.ascontiguousarray(np.broadcast_to(np.eye(3), t.N.shape))
    newton(t.Ue, t.N, t.Us, t.size, lam, phi, iso, out)
    U = [np.empty((4, 3, 3)) for _ in range(2)]
    for h, at in zip((-1e-6, 1e-6), U):
        place(eye, t.Ue, t.N, t.Us, lam + h, iso, at, np.empty(4))
    slope = (t.N * (U[1] - U[0])).sum((1, 2)) / 2e-6
    np.testing.assert_allclose(out, -phi / (t.size * slope), rtol=1e-7)


def test_the_plastic_part_keeps_its_volume() -> None:
    t, _ = trial()
    L = np.eye(3) - 0.02 * t.N
    U = np.empty((4, 3, 3))
    eye = np.ascontiguousarray(np.broadcast_to(np.eye(3), U.shape))
    place(eye, t.Ue, t.N, t.Us, np.full(4, 0.02), 1, U, np.empty(4))
    X = t.Ue @ L
    beta = np.linalg.det(t.Us @ L) ** (-1.0 / 3.0)
    np.testing.assert_allclose(U, 0.5 * (X + np.swapaxes(X, 1, 2)) * beta[:, None, None], atol=1e-14)


@pytest.mark.parametrize(
    ("l", "p", "root", "other"),
    [
        ((0.0, 1.0, 2.0), (3.0, 0.0, -1.0), 1.0, 3.0),  # (x - 1)(x - 3)
        ((0.0, 1.0, 2.0), (-2.0, -2.0, 0.0), 2.0, None),  # (x + 1)(x - 2): the positive one
        ((0.0, 1.0, 2.0), (2.0, 1.0, 0.0), 2.0, None),  # a line
        ((0.0, 1.0, 1.0), (2.0, 1.0, 1.0), 1.0, None),  # two coincide
    ],
)
def test_roots_of_three_trials(
    l: tuple[float, ...], p: tuple[float, ...], root: float, other: float | None
) -> None:
    out = np.empty(3)
    parabola_root(*l, *p, out)
    assert out[0] == pytest.approx(root)
    assert np.isnan(out[1]) if other is None else out[1] == pytest.approx(other)


def test_von_mises_stress_and_its_derivative() -> None:
    s = RANDOM.standard_normal((3, 6))
    at, K, g, none = np.array([0, 3, 5, 3, 1, 4, 5, 4, 2]), np.empty(3), np.empty((3, 3, 3)), np.empty((0, 3, 3))
    mises(s, K, g)
    m = s[:, at].reshape(3, 3, 3)
    d = m - np.trace(m, axis1=1, axis2=2)[:, None, None] / 3.0 * np.eye(3)
    np.testing.assert_allclose(K, np.sqrt(1.5 * (d**2).sum((1, 2))))
    K2 = np.empty(3)
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))):
        more = s.copy()
        more[:, k] += 1e-6
        mises(more, K2, none)
        np.testing.assert_allclose((K2 - K) / 1e-6, g[:, i, j] * (1.0 if k < 3 else 2.0), atol=1e-5)


def test_stress_of_the_base_is_on_the_line() -> None:
    """The trial's measure is that of its base at F(lam)."""
    t, _ = trial()
    lam = np.full(4, 0.01)
    K = t.measure(lam).copy()
    s, _ = evaluate(t.base, Points.at(t.F(lam).copy()), False)
    out = np.empty(4)
    mises(s, out, np.empty((0, 3, 3)))
    np.testing.assert_allclose(K, out, rtol=1e-12)


def test_octahedral_shear_strain() -> None:
    F, out = near_identity(4, 0.3), np.empty(4)
    octahedral(F, out)
    E = 0.5 * (np.swapaxes(F, 1, 2) @ F - np.eye(3))
    l = np.linalg.eigvalsh(E)
    apart = (l[:, 0] - l[:, 1]) ** 2 + (l[:, 1] - l[:, 2]) ** 2 + (l[:, 2] - l[:, 0]) ** 2
    np.testing.assert_allclose(out, np.sqrt(2.0) / 3.0 * np.sqrt(apart), rtol=1e-12)
