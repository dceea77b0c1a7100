"""Electroneutrality and partition coefficients: the balance itself, and derivatives by differences."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.multiphasic.electroneutrality import potential
from febkit.solver.multiphasic.partition import by_bound, partition
from febkit.solver.multiphasic.solution import Solution
from febkit.solver.points import Points
from helpers.mixture_element import mixture, solute

RNG = np.random.default_rng(2)


@pytest.mark.parametrize("z", [(1, -1), (1, -1, 0, 1), (2, -1), (2, -1, 1, -2), (3, -2, 1), (-1,), (1,)], ids=str)
def test_the_solution_is_neutral(z: tuple[int, ...]) -> None:
    charges = np.array(z, dtype=float)
    kc = RNG.uniform(0.1, 3.0, (50, len(z)))
    cF = RNG.uniform(-5.0, 5.0, 50)
    if len(z) == 1:
        cF = -np.sign(charges[0]) * np.abs(cF)
    y = potential(charges, kc, cF, np.zeros(50))
    terms = charges * kc * np.exp(charges * y[:, None])
    assert np.abs(terms.sum(axis=1) + cF).max() < 1e-12 * np.abs(terms).max()


def test_donnan() -> None:
    """Ideal Donnan equilibrium: c+ c- = c0^2 and c+ - c- = -cF, also far from balance, where roots cancel."""
    c0, cF = 0.15, np.array([-0.2, 0.2, -1e4, 1e4, 0.0])
    y = potential(np.array([1.0, -1.0]), np.full((5, 2), c0), cF, np.zeros(5))
    plus, minus = c0 * np.exp(y), c0 * np.exp(-y)
    assert np.allclose(plus * minus, c0**2, rtol=1e-14)
    rare = np.minimum(plus, minus)
    assert np.allclose(rare, c0**2 / (0.5 * (np.abs(cF) + np.sqrt(cF**2 + 4 * c0**2))), rtol=1e-12)


@pytest.mark.parametrize("cF", [-1.0, 1.0])
def test_no_ion_of_the_charge_that_is_asked_for(cF: float) -> None:
    """Without ions, or with those of the wrong sign alone, there is no potential: zero rather than no number."""
    y = potential(np.array([1.0, -1.0]), np.zeros((1, 2)), np.array([cF]), np.zeros(1))
    assert y[0] == 0.0
    z = np.array([np.sign(cF)])
    assert potential(z, np.ones((1, 1)), np.array([cF]), np.zeros(1))[0] == 0.0
    assert potential(2 * z, np.ones((1, 1)), np.array([cF]), np.zeros(1))[0] == 0.0


def test_neutral_solutes_need_no_potential() -> None:
    assert not potential(np.zeros(2), np.ones((3, 2)), np.full(3, -1.0), np.zeros(3)).any()


N, FREE, RHO, MOLAR, CHARGE = 4, 0.8, np.array([6.0]), np.array([1.5]), np.array([-2.0])
MIX = mixture(tuple(solute(i, z) for i, z in enumerate((2, -1, 1))))


def evaluated(J: np.ndarray, c: np.ndarray, bound: np.ndarray) -> tuple[Points, Solution, object]:
    """A mixture whose volume fraction and charge depend on one solid-bound molecule."""
    phi0 = 0.2 + (bound / RHO).sum(axis=1)
    sol = Solution.at(MIX.z, c, phi0, bound, MOLAR, CHARGE, RHO)
    sol.cF[:] = (-0.4 * FREE + (bound * CHARGE / MOLAR).sum(axis=1)) / (J - phi0)
    pts = Points.at(np.eye(3) * np.cbrt(J)[:, None, None])
    return pts, sol, partition(MIX, pts, sol, np.zeros(N))


def test_derivatives_of_partition_coefficients() -> None:
    J, c = RNG.uniform(0.9, 1.2, N), RNG.uniform(0.5, 1.5, (N, 3))
    bound, h = RNG.uniform(0.2, 0.6, (N, 1)), 1e-6
    pts, sol, p = evaluated(J, c, bound)

    def slope(f, dJ: float = 0.0, dc: int = -1, db: float = 0.0):  # type: ignore[no-untyped-def]
        step = np.zeros(3)
        if dc >= 0:
            step[dc] = h
        plus, minus = (evaluated(J + s * dJ, c + s * step, bound + s * db) for s in (1, -1))
        return (f(plus) - f(minus)) / (2 * h)

    assert np.allclose(sol.dkdJ, slope(lambda q: q[1].kappa, dJ=h), rtol=1e-7)
    for j in range(3):
        assert np.allclose(sol.dkdc[:, :, j], slope(lambda q: q[1].kappa, dc=j), rtol=1e-7)
    q = by_bound(p, pts, sol)  # type: ignore[arg-type]
    assert np.allclose(q.r[..., 0], slope(lambda q: q[1].kappa, db=h), rtol=1e-7)
