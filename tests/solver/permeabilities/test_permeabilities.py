"""Each permeability: its tangent by finite differences, frame indifference, known values."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver import permeabilities, supplies
from febkit.solver.law import PoreCollapse
from febkit.solver.points import Points
from febkit.solver.values import Map

RNG = np.random.default_rng(5)
PHI = np.array([0.3])
LAWS = {
    "perm-const-iso": {"perm": 0.7},
    "perm-Holmes-Mow": {"perm": 0.7, "M": 1.3, "alpha": 2.1},
    "perm-exp-iso": {"perm": 0.7, "M": 1.3},
    "perm-ref-iso": {"perm0": 0.7, "perm1": 0.4, "perm2": 0.3, "M": 1.3, "alpha": 2.1},
    "perm-ref-trans-iso": {
        "perm0": 0.7, "perm1T": 0.4, "perm1A": 0.6, "perm2T": 0.3, "perm2A": 0.5, "M0": 1.3, "MT": 0.8,
        "MA": 0.4,
        "alpha0": 2.1, "alphaT": 1.7, "alphaA": 1.2,
    },
    "perm-ref-ortho": {
        "perm0": 0.7, "M0": 1.3, "alpha0": 2.1, "perm1": (0.4, 0.5, 0.6), "perm2": (0.3, 0.2, 0.1),
        "M": (0.8, 0.4, 0.2), "alpha": (1.7, 1.2, 0.5),
    },
}
VOIGT = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]


def full(v: np.ndarray) -> np.ndarray:
    out = np.empty((*v.shape[:-1], 3, 3))
    for r, (i, j) in enumerate(VOIGT):
        out[..., i, j] = out[..., j, i] = v[..., r]
    return out


def rotation() -> np.ndarray:
    q, r = np.linalg.qr(RNG.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def evaluate(name: str, F: np.ndarray, Q: np.ndarray, tangent: bool = True) -> tuple[np.ndarray, np.ndarray]:
    law = permeabilities.load(name)(**LAWS[name])
    pts = Points.at(F, Q=Q)
    K, dK = np.zeros((pts.n, 6)), np.zeros((pts.n, 6, 6))
    law.permeability(pts, PHI, K, dK if tangent else None)
    return full(K), dK


@pytest.fixture(scope="module")
def state() -> tuple[np.ndarray, np.ndarray]:
    F = np.eye(3) + 0.25 * RNG.uniform(-1, 1, (4, 3, 3))
    return F, np.array([rotation() for _ in range(4)])


@pytest.mark.parametrize("name", permeabilities.TYPES)
def test_tangent_by_finite_difference(name: str, state: tuple[np.ndarray, np.ndarray]) -> None:
    F, Q = state
    K, dK = evaluate(name, F, Q)
    h = 1e-6
    for r, (i, j) in enumerate(VOIGT):
        e = np.zeros((3, 3))
        e[i, j] += 0.5
        e[j, i] += 0.5
        forward, _ = evaluate(name, F + h * e @ F, Q)
        backward, _ = evaluate(name, F - h * e @ F, Q)
        rate = (forward - backward) / (2 * h)
        exact = K * np.trace(e) + rate - e @ K - K @ e
        np.testing.assert_allclose(full(dK[:, :, r]), exact, atol=2e-8)


@pytest.mark.parametrize("name", permeabilities.TYPES)
def test_a_rotation_turns_the_tensor(name: str, state: tuple[np.ndarray, np.ndarray]) -> None:
    F, Q = state
    R = rotation()
    K, _ = evaluate(name, F, Q, tangent=False)
    turned, _ = evaluate(name, R @ F, Q, tangent=False)
    np.testing.assert_allclose(turned, R @ K @ R.T, atol=1e-13)


@pytest.mark.parametrize("name", permeabilities.TYPES)
def test_positive_definite(name: str, state: tuple[np.ndarray, np.ndarray]) -> None:
    K, _ = evaluate(name, *state, tangent=False)
    assert (np.linalg.eigvalsh(K) > 0).all()


@pytest.mark.parametrize("name", ["perm-const-iso", "perm-Holmes-Mow", "perm-exp-iso"])
def test_value_at_rest(name: str) -> None:
    K, _ = evaluate(name, np.eye(3)[None], np.eye(3)[None], tangent=False)
    np.testing.assert_allclose(K[0], 0.7 * np.eye(3), atol=1e-15)


def test_equal_axes_are_isotropic(state: tuple[np.ndarray, np.ndarray]) -> None:
    """ref-iso against its closed form k0 I + k1 b + 2 k2 b^2."""
    F, Q = state
    p = LAWS["perm-ref-iso"]
    J = np.linalg.det(F)[:, None, None]
    b = F @ F.transpose(0, 2, 1)
    f = ((J - PHI) / (1 - PHI)) ** p["alpha"] * np.exp(p["M"] * (J * J - 1) / 2)
    exact = f * (p["perm0"] * np.eye(3) + p["perm1"] / J**2 * b + p["perm2"] / J**4 * b @ b)
    np.testing.assert_allclose(evaluate("perm-ref-iso", F, Q, tangent=False)[0], exact, atol=1e-13)


def test_a_map_gives_each_element_its_own_number() -> None:
    law = permeabilities.load("perm-const-iso")(perm=Map(np.array([1.0, 2.0, 3.0])))
    K = np.zeros((3, 6))
    law.permeability(Points.at(np.tile(np.eye(3), (3, 1, 1))), PHI, K, None)
    np.testing.assert_array_equal(K[:, :3], np.repeat([[1.0], [2.0], [3.0]], 3, axis=1))


def test_closed_pores_are_named() -> None:
    law = permeabilities.load("perm-Holmes-Mow")(perm=1.0, alpha=2.0)
    F = np.array([np.eye(3), np.diag([1.0, 1.0, 0.2])])
    with pytest.raises(PoreCollapse) as error:
        law.permeability(Points.at(F), PHI, np.zeros((2, 6)), None)
    assert error.value.element == 1


def test_starling() -> None:
    law = supplies.load("Starling")(kp=0.4, pv=3.0)
    pts = Points.at(np.tile(np.eye(3), (2, 1, 1)))
    q, dp = np.zeros(2), np.zeros(2)
    law.supply(pts, np.array([1.0, 5.0]), q, None, dp)
    np.testing.assert_allclose(q, [0.8, -0.8])
    np.testing.assert_allclose(dp, -0.4)
