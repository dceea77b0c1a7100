"""Stress and tangent of power-law fibers, near whole exponents and away from them."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.kernels.fibers import add_fibers, add_power_fibers


@pytest.mark.parametrize("iso", [False, True], ids=["compressible", "distortional"])
@pytest.mark.parametrize("beta", [2.0, 3.0, 3.0 + 4e-16, 2.5, 4.2])
def test_sums_over_fibers_of_given_tension(beta: float, iso: bool) -> None:
    """sn = 2 In dW/dIn and cn = 4 In^2 d2W/dIn2 of W = ksi (In - 1)^beta; nothing in compression."""
    rng = np.random.default_rng(3)
    F = np.eye(3) + 0.3 * rng.uniform(-1, 1, (4, 3, 3))
    J, A, w = np.linalg.det(F), rng.normal(size=(1, 20, 3)), rng.uniform(0.5, 1.0, 20)
    A /= np.linalg.norm(A, axis=2, keepdims=True)
    ksi, q = rng.uniform(0.5, 2.0, (1, 20)), np.full((1, 20), beta)
    In = (np.einsum("nij,mj->nmi", F, A[0]) ** 2).sum(2) * (J[:, None] ** (-2 / 3) if iso else 1.0)
    x = np.maximum(In - 1.0, 0.0)
    second = np.where(x > 0.0, np.where(x > 0.0, x, 1.0) ** (beta - 2.0), 0.0)
    sn, cn = 2.0 * In * ksi * beta * x ** (beta - 1.0), 4.0 * In**2 * ksi * beta * (beta - 1.0) * second
    assert 0 < (x > 0.0).sum() < x.size
    want, got = ((np.zeros((4, 6)), np.zeros((4, 6, 6))) for _ in range(2))
    add_fibers(F, J, A, w[None], In, sn, cn, np.empty((0, 0)), iso, *want)
    add_power_fibers(F, J, A, w, np.empty((0, 3, 3)), ksi, q, iso, *got)
    for a, b in zip(got, want, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-13)


def test_lengths_in_an_ellipsoid_along_axes_are_those_given_by_direction() -> None:
    """1/ksi^2 = sum (N . e_k)^2 / ksi_k^2 along turned axes e_k, and so for beta."""
    rng = np.random.default_rng(4)
    F, N, w = np.eye(3) + 0.3 * rng.uniform(-1, 1, (4, 3, 3)), rng.normal(size=(1, 20, 3)), rng.uniform(0.5, 1.0, 20)
    N /= np.linalg.norm(N, axis=2, keepdims=True)
    Q = np.linalg.qr(rng.normal(size=(4, 3, 3)))[0]
    axes = [rng.uniform(0.5, 2.0, (1, 3)), rng.uniform(2.1, 4.0, (1, 3))]
    by_direction = [(((N @ Q) / a[:, None, :]) ** 2).sum(2) ** -0.5 for a in axes]
    want, got = ((np.zeros((4, 6)), np.zeros((4, 6, 6))) for _ in range(2))
    add_power_fibers(F, np.linalg.det(F), N, w, np.empty((0, 3, 3)), *by_direction, False, *want)
    add_power_fibers(F, np.linalg.det(F), N, w, np.ascontiguousarray(Q), *(a**-2.0 for a in axes), False, *got)
    assert np.abs(want[1]).max() > 0.0
    for a, b in zip(got, want, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-13)
