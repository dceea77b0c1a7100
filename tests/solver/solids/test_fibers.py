"""Quadrature of fiber directions, local axes and fiber directions."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.points import Points
from febkit.solver.solids import axes
from febkit.solver.solids.base import evaluate
from febkit.solver.solids.registry import load, tables

WHOLE = {
    "fibers-3d-fei": {"resolution": 610},
    "fibers-3d-geodesic": {"resolution": 1},
    "fibers-3d-gauss": {"nph": 8, "nth": 20},
    "fibers-3d-gkt": {"nph": 15, "nth": 31},
}


@pytest.mark.parametrize("name", sorted(WHOLE))
def test_scheme_integrates_over_the_sphere(name):
    N, w = load("scheme", name)(**WHOLE[name]).whole()
    np.testing.assert_allclose(w.sum(), 4 * np.pi, rtol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(N, axis=2), 1.0, rtol=1e-9)
    second = np.einsum("nm,nmi,nmj->ij", w, N, N)
    np.testing.assert_allclose(second, 4 * np.pi / 3 * np.eye(3), atol=1e-2)


def test_trapezoidal_scheme_goes_round_the_plane():
    N, w = load("scheme", "fibers-2d-trapezoidal")(nth=31).whole()
    np.testing.assert_allclose(np.einsum("nm,nmi,nmj->ij", w, N, N), np.pi * np.diag([1, 1, 0]), atol=1e-12)


@pytest.mark.parametrize("name", ["fibers-3d-gauss", "fibers-3d-gkt"])
def test_taut_schemes_leave_out_slack_directions_only(name):
    F = np.eye(3) + 0.2 * np.random.default_rng(4).uniform(-1, 1, (20, 3, 3))
    fibers = load("fiber", "fiber-exp-pow")(beta=3.0, ksi=1.0)
    density = load("distribution", "von-Mises-3d")(b=1.0)
    stresses = []
    for scheme in (load("scheme", name)(nph=7, nth=61), load("scheme", "fibers-3d-fei")(resolution=1796)):
        solid = load("solid", "continuous fiber distribution")(fibers, density, scheme)
        stresses.append(evaluate(solid, Points.at(F), False)[0])
    np.testing.assert_allclose(stresses[0], stresses[1], atol=5e-3 * np.abs(stresses[1]).max())


@pytest.mark.parametrize("name", sorted(tables()["distribution"]))
def test_density_is_even(name):
    kw = {"von-Mises-3d": {"b": 1.0}, "von-Mises-2d": {"b": 1.0}, "ellipsoidal": {"spa": (1, 2, 3)}}.get(name, {})
    R = load("distribution", name)(**kw)
    N = np.random.default_rng(2).normal(size=(1, 5, 3))
    N /= np.linalg.norm(N, axis=2, keepdims=True)
    pts = Points.at(np.eye(3)[None])
    if name == "von-Mises-3d-two-axisym":
        R.cosg = 0.8
    np.testing.assert_allclose(R(pts, N), R(pts, -N))


def _points(X):
    pts = Points.at(np.tile(np.eye(3), (len(X), 1, 1)))
    pts.X = np.asarray(X, dtype=float)
    return pts


MAKERS = {
    "vector": axes.vector_axes((1, 2, 0), (0, 1, 3)),
    "parallel": axes.vector_axes((0, 1, 0), (0, 1, 0)),
    "spherical": axes.SphericalAxes((0.1, 0, 0)),
    "cylindrical": axes.CylindricalAxes(),
    "polar": axes.PolarAxes(vector1=(0, 0, 1), vector2=(0, 1, 1), radius1=0.2, radius2=2.0),
    "angles": axes.AngleAxes(30.0, 60.0),
    "local": axes.local_axes(np.random.default_rng(0).normal(size=(4, 8, 3))),
}


@pytest.mark.parametrize("name", sorted(MAKERS))
def test_axes_are_right_handed_and_orthonormal(name):
    Q = MAKERS[name](_points(np.random.default_rng(1).normal(size=(4, 3))))
    np.testing.assert_allclose(np.swapaxes(Q, 1, 2) @ Q, np.broadcast_to(np.eye(3), Q.shape), atol=1e-12)
    assert (np.linalg.det(Q) > 0).all()


def test_radial_directions():
    X = np.array([[1.0, 2.0, 3.0], [0.3, -1.0, 0.2]])
    np.testing.assert_allclose(axes.SphericalVector()(_points(X)), axes.unit(X), atol=1e-12)
    across = X * [1, 1, 0]
    np.testing.assert_allclose(axes.CylindricalVector()(_points(X)), axes.unit(across), atol=1e-12)
    np.testing.assert_allclose(axes.CylindricalAxes()(_points(X))[:, :, 0], axes.unit(across), atol=1e-12)
    np.testing.assert_allclose(axes.AngleVector(90.0, 45.0)(_points(X))[0], [0, 0.5**0.5, 0.5**0.5], atol=1e-12)


def test_own_axes_turn_with_those_above():
    """A fiber along e1 of its own axes, within axes of the mixture, within axes of the element."""
    Qe = axes.vector_axes((1, 1, 0), (0, 1, 0)).Q
    Qm = axes.vector_axes((0, 1, 1), (1, 0, 0)).Q
    Qf = axes.vector_axes((1, 2, 3), (0, 0, 1)).Q
    F = np.eye(3)[None] + 0.1 * np.random.default_rng(3).uniform(-1, 1, (3, 3, 3))
    fiber = load("solid", "fiber-NH")
    nested = load("solid", "solid mixture")(
        solid=(fiber(mu=2.0, mat_axis=axes.FixedAxes(Qf)),), mat_axis=axes.FixedAxes(Qm)
    )
    a0 = (Qe @ Qm @ Qf)[:, :, 0]
    direct = fiber(mu=2.0, fiber=axes.fixed_vector(a0))
    got = evaluate(nested, Points.at(F, Q=Qe), False)[0]
    np.testing.assert_allclose(got, evaluate(direct, Points.at(F), False)[0], atol=1e-14)


@pytest.mark.parametrize("name", ["HGO unconstrained", "Holzapfel-Gasser-Ogden"])
def test_fibers_of_a_wall_at_rest_are_stiff_for_what_stretches_them(name: str) -> None:
    """Where fibers begin to bear the tangent is that of the stretch, not the mean of both sides, which slows Newton."""
    law = load("solid", name)(c=0.01, k1=1.0, k2=500.0, kappa=0.2, gamma=50.0, k=0.8)
    s, C = np.zeros((1, 6)), np.zeros((1, 6, 6))
    law.stress(Points.at(np.eye(3)[None]), s, C)
    h = 1e-7
    for axis in (0, 1):
        F = np.eye(3)
        F[axis, axis] += h
        stretched = np.zeros((1, 6))
        law.stress(Points.at(F[None]), stretched, None)
        assert (stretched - s)[0, axis] / h == pytest.approx(C[0, axis, axis], rel=1e-3)
