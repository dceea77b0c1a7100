"""Tension of power-law fibers, near whole exponents and away from them."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.kernels.fibers import power_tension


@pytest.mark.parametrize("beta", [2.0, 3.0, 3.0 + 4e-16, 2.5, 4.2])
def test_tension_is_the_derivative_of_the_energy(beta: float) -> None:
    """sn = 2 In dW/dIn and cn = 4 In^2 d2W/dIn2 of W = ksi (In - 1)^beta; nothing in compression."""
    In, ksi = np.array([[0.7, 1.0, 1.02, 1.3, 2.0]]), np.array([[3.0, 1.0, 2.0, 0.5, 0.1]])
    sn, cn = np.empty_like(In), np.empty_like(In)
    power_tension(In, ksi, np.full_like(In, beta), sn, cn)
    x = np.maximum(In - 1.0, 0.0)
    on = x > 0
    np.testing.assert_allclose(sn, np.where(on, 2 * In * ksi * beta * x ** (beta - 1), 0.0), rtol=1e-13)
    second = np.where(on, x, 1.0) ** (beta - 2)
    np.testing.assert_allclose(cn, np.where(on, 4 * In**2 * ksi * beta * (beta - 1) * second, 0.0), rtol=1e-13)
