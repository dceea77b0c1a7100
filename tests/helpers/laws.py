"""Laws every solid obeys, checked by differences."""

from __future__ import annotations

import numpy as np

from febkit.solver.points import Points
from febkit.solver.solids.base import Solid

VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


def full(s):
    """(n, 6) -> (n, 3, 3)."""
    out = np.empty((len(s), 3, 3))
    for k, (a, b) in enumerate(VOIGT):
        out[:, a, b] = out[:, b, a] = s[:, k]
    return out


def full4(c):
    """(n, 6, 6) -> (n, 3, 3, 3, 3)."""
    out = np.empty((len(c), 3, 3, 3, 3))
    for k, (a, b) in enumerate(VOIGT):
        for m, (p, q) in enumerate(VOIGT):
            for i, j in ((a, b), (b, a)):
                out[:, i, j, p, q] = out[:, i, j, q, p] = c[:, k, m]
    return out


def deformations(n=6, size=0.25, seed=1):
    """Random deformation gradients with det F > 0 and without symmetry."""
    rng = np.random.default_rng(seed)
    F = np.eye(3) + size * rng.uniform(-1, 1, (n, 3, 3))
    assert (np.linalg.det(F) > 0.2).all()
    return F


def rotation(seed=3):
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def stress_of(solid: Solid, pts: Points):
    s = np.zeros((pts.n, 6))
    solid.stress(pts, s, None)
    return s


def first_piola(solid, make, F):
    pts = make(F)
    P = pts.J[:, None, None] * full(stress_of(solid, pts)) @ np.swapaxes(np.linalg.inv(F), 1, 2)
    return P


def check_stress_is_derivative_of_energy(solid, make, F, rtol=1e-6, h=1e-5):
    P = first_piola(solid, make, F)
    D = np.empty_like(P)
    for a in range(3):
        for b in range(3):
            dF = np.zeros((3, 3))
            dF[a, b] = h
            D[:, a, b] = (
                8 * (solid.energy(make(F + dF)) - solid.energy(make(F - dF)))
                - (solid.energy(make(F + 2 * dF)) - solid.energy(make(F - 2 * dF)))
            ) / (12 * h)
    scale = max(np.abs(P).max(), 1e-12)
    np.testing.assert_allclose(D, P, atol=rtol * scale, rtol=0)
    assert np.abs(P).max() > 0


def numerical_tangent(solid, make, F, h=1e-5):
    """c = J^-1 push-forward of 2 dS/dC by fourth-order differences of the stress under F -> (I + h d) F."""
    n = len(F)
    J = np.linalg.det(F)
    s0 = full(stress_of(solid, make(F)))
    c = np.empty((n, 3, 3, 3, 3))
    eye = np.eye(3)
    for a in range(3):
        for b in range(3):
            d = np.zeros((3, 3))
            d[a, b] += 0.5
            d[b, a] += 0.5

            def tau(t, d=d):
                G = (eye + t * d) @ F
                return np.linalg.det(G)[:, None, None] * full(stress_of(solid, make(G)))

            lie = (8 * (tau(h) - tau(-h)) - (tau(2 * h) - tau(-2 * h))) / (12 * h)
            lie -= J[:, None, None] * (d @ s0 + s0 @ d)
            c[:, :, :, a, b] = lie / J[:, None, None]
    return c


def check_tangent_is_derivative_of_stress(solid, make, F, rtol=1e-6, h=1e-5):
    pts = make(F)
    s, c = np.zeros((pts.n, 6)), np.zeros((pts.n, 6, 6))
    solid.stress(pts, s, c)
    np.testing.assert_allclose(s, stress_of(solid, make(F)), rtol=1e-12, atol=1e-12 * np.abs(s).max())
    D = numerical_tangent(solid, make, F, h)
    scale = max(np.abs(D).max(), np.abs(s).max())
    np.testing.assert_allclose(full4(c), D, atol=rtol * scale, rtol=0)
    if solid.symmetric:
        np.testing.assert_allclose(c, np.swapaxes(c, 1, 2), atol=1e-11 * np.abs(c).max())


def check_frame_indifference(solid, make, F):
    R = rotation()
    turned = R @ full(stress_of(solid, make(F))) @ R.T
    s = full(stress_of(solid, make(R @ F)))
    np.testing.assert_allclose(s, turned, atol=1e-10 * np.abs(s).max(), rtol=0)


def check_rest_is_free_of_stress(solid, make, scale):
    s = stress_of(solid, make(np.eye(3)[None].copy()))
    np.testing.assert_allclose(s, 0.0, atol=1e-11 * scale)


def check_tangent_adds(solid, make, F):
    pts = make(F)
    s, c = np.zeros((pts.n, 6)), np.zeros((pts.n, 6, 6))
    solid.stress(pts, s, c)
    s2, c2 = np.ones((pts.n, 6)), np.ones((pts.n, 6, 6))
    solid.stress(make(F), s2, c2)
    np.testing.assert_allclose(s2 - 1, s, atol=1e-9 * max(1, np.abs(s).max()))
    np.testing.assert_allclose(c2 - 1, c, atol=1e-9 * max(1, np.abs(c).max()))
