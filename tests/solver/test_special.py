"""Special functions against scipy's."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.special as reference

from febkit.solver import special

X = np.concatenate([np.logspace(-12, 2.8, 400), [0.5, 1.0, 1.0 - 1e-15, 1.0 + 1e-15, 2.0, 700.0]])


def test_erfc_and_gamma_of_both_signs() -> None:
    x = np.linspace(-6.0, 6.0, 301)
    np.testing.assert_allclose(special.erfc(x), reference.erfc(x), rtol=1e-13)
    np.testing.assert_allclose(special.gamma(np.abs(x) + 0.01), reference.gamma(np.abs(x) + 0.01), rtol=1e-13)


@pytest.mark.parametrize("a", [0.05, 0.5, 1.0, 1.5, 4.0, 30.0, 150.0])
def test_incomplete_gamma(a: float) -> None:
    np.testing.assert_allclose(special.gammainc(a, X), reference.gammainc(a, X), rtol=1e-11, atol=1e-300)
    np.testing.assert_allclose(special.gammaincc(a, X), reference.gammaincc(a, X), rtol=1e-11, atol=2e-16)
    assert special.gammainc(a, 0.0) == 0.0 and special.gammaincc(a, 0.0) == 1.0
    assert special.gammainc(a, np.inf) == 1.0 and special.gammaincc(a, np.inf) == 0.0


def test_shapes_are_broadcast() -> None:
    assert special.gammainc(np.full((3, 1), 2.0), np.ones((1, 4))).shape == (3, 4)
    assert special.erfc(2.0).shape == () and special.erfc(np.ones((2, 0))).shape == (2, 0)


def test_exponential_integral_of_both_signs() -> None:
    x = np.concatenate([X, -X, [1.0, -1.0, 40.0, 39.999, 0.372, -0.999999]])
    np.testing.assert_allclose(special.expi(x), reference.expi(x), rtol=1e-12, atol=2e-16)
    assert special.expi(0.0) == -np.inf
    assert special.expi(-800.0) == 0.0


def test_modified_bessel_function() -> None:
    x = np.concatenate([X, [2.0 + 1e-15, 1.999, 3.7]])
    np.testing.assert_allclose(special.k1(x), reference.k1(x), rtol=2e-14, atol=1e-300)
    assert special.k1(0.0) == np.inf and np.isnan(special.k1(-1.0))
