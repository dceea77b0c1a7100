"""Solids, permeabilities and supplies whose numbers differ from point to point."""

from __future__ import annotations

import re
from functools import partial

import numpy as np
import pytest

from febkit.solver import permeabilities, supplies
from febkit.solver.points import Points
from febkit.solver.solids import history
from febkit.solver.solids.registry import tables
from helpers import examples, laws, varying

N = 6
Q = laws.rotation(5)[None]
F = laws.deformations(N, 0.18)
SOLIDS = {n: partial(examples.example, n) for n in sorted({**tables()["solid"], "generation": ""})}
ALL = SOLIDS | examples.nested()


def at(G, e, t=0.6, **kw):
    pts = Points.at(G, Q=Q, t=t, dt=0.3, **kw)
    pts.e = e
    pts.extra["bound"] = np.full((len(G), 1), 0.6)  # of the solids that go by a solid-bound molecule
    return pts


def later(solid, G, e):
    """The history (n, h) after one converged step, and points made with it."""
    first = at(np.eye(3) + 0.5 * (G - np.eye(3)), e, 0.3)
    first.old = history.begin(solid, first)
    first.new = np.zeros_like(first.old)
    laws.stress_of(solid, first)
    old = history.begin(solid, at(G, e, old=first.new))
    return lambda H: at(H, e, old=old, new=np.zeros_like(old))


def answers(solid, G, e):
    """Stress, tangent, energy and density after one converged step."""
    pts, n = later(solid, G, e)(G), len(G)
    s, c = np.zeros((n, 6)), np.zeros((n, 6, 6))
    solid.stress(pts, s, c)
    try:
        W = np.broadcast_to(solid.energy(pts), (n,))
    except NotImplementedError:
        W = np.zeros(n)
    return {"stress": s, "tangent": c, "energy": W, "density": np.broadcast_to(solid.density(pts), (n,))}


def varied(name):
    solid = ALL[name]()
    varying.varied(solid, N)
    return solid


@pytest.mark.parametrize("name", ALL)
def test_a_point_among_others_is_as_it_is_alone(name):
    whole = answers(varied(name), F, np.arange(N))
    for k in range(N):
        one = varying.alone(varied(name), k)
        for what, value in answers(one, F[k : k + 1], np.zeros(1, int)).items():
            scale = max(np.abs(whole[what]).max(), 1e-300)
            np.testing.assert_allclose(whole[what][k], value[0], atol=1e-13 * scale, rtol=1e-12, err_msg=what)


WITHOUT_EFFECT = {  # numbers that have none here
    r".*\.density_": "the root's counts",
    r"(Carter-Hayes|.* sbm): density_": "that of the molecule counts",
    r".*start_time": "a generation begins with a step",
    r"t0": "damage has begun",
    r"rtol": "a tolerance",
    r"a\[\d\]": "of active contraction, and there is none",
    r"phis0": "not given: the water fraction is",
    r"m[3-6]": "of terms that are not there",
    r"t[2-6]": "of terms that are not there",
    r"lam_max": "of stretches that are not reached",
    r"lp33": "of stretches that are not reached",
    r"(min|max)_density": "bounds that are not reached",
    r"remodeling solid: density_": "its solid's counts",
    r"elastic\.(c5|lambda_)": "of stretches that are not reached",
}


@pytest.mark.parametrize("name", ALL)
def test_each_number_counts_at_its_own_point(name):
    """No number is taken from one point for all."""
    same, idle = answers(ALL[name](), F, np.arange(N)), []
    for number in varying.varied(ALL[name](), N):
        solid = ALL[name]()
        varying.varied(solid, N, number)
        one = answers(solid, F, np.arange(N))
        change = [np.abs(one[k] - same[k]).reshape(N, -1).max(axis=1) for k in same]
        if not np.max(change, axis=0)[1:].max() > 0.0:
            idle.append(number)
    if name != "cdf: CDF step":  # all or nothing
        said = [q for q in idle if not any(re.fullmatch(k, t) for k in WITHOUT_EFFECT for t in (q, f"{name}: {q}"))]
        assert said == []


@pytest.mark.parametrize("name", SOLIDS)
def test_stress_is_derivative_of_energy(name):
    if name in examples.NO_ENERGY_LAW:
        pytest.skip(examples.NO_ENERGY_LAW[name])
    solid = varied(name)
    laws.check_stress_is_derivative_of_energy(solid, later(solid, F, np.arange(N)), F)


@pytest.mark.parametrize("name", SOLIDS)
def test_tangent_is_derivative_of_stress(name):
    if name in examples.NO_TANGENT_LAW:
        pytest.skip(examples.NO_TANGENT_LAW[name])
    solid = varied(name)
    laws.check_tangent_is_derivative_of_stress(solid, later(solid, F, np.arange(N)), F, rtol=3e-6)


@pytest.mark.parametrize("name", SOLIDS)
def test_frame_indifference(name):
    if name in examples.NOT_OBJECTIVE:
        pytest.skip(examples.NOT_OBJECTIVE[name])
    solid = varied(name)
    laws.check_frame_indifference(solid, later(solid, F, np.arange(N)), F)


# ---- permeabilities and supplies ------------------------------------------------------------------------------------


def flow(law, G, e, phi):
    K, D = np.zeros((len(G), 6)), np.zeros((len(G), 6, 6))
    law.permeability(at(G, e), phi, K, D)
    return K, D


@pytest.mark.parametrize("name", permeabilities.TYPES)
def test_permeabilities_at_a_point_among_others(name):
    """With a solid volume fraction that varies too; the tangent is that of the point's own numbers."""
    phi = np.linspace(0.2, 0.4, N)

    def law():
        out = permeabilities.load(name)(**varying.PERMEABILITIES[name])
        assert varying.varied(out, N)
        return out

    whole = flow(law(), F, np.arange(N), phi)
    for k in range(N):
        one = flow(varying.alone(law(), k), F[k : k + 1], np.zeros(1, int), phi[k : k + 1])
        for a, b in zip(whole, one, strict=True):
            np.testing.assert_allclose(a[k], b[0], rtol=1e-12, atol=1e-14)
    first = flow(varying.alone(law(), 0), F, np.arange(N), phi)
    assert np.abs(whole[0][1:] - first[0][1:]).max() > 1e-3


@pytest.mark.parametrize("name", permeabilities.TYPES)
def test_tangents_of_permeabilities_that_vary(name):
    law = permeabilities.load(name)(**varying.PERMEABILITIES[name])
    varying.varied(law, N)
    phi, e, h = np.linspace(0.2, 0.4, N), np.arange(N), 1e-6
    K, D = flow(law, F, e, phi)
    for r, (i, j) in enumerate(laws.VOIGT):
        d = np.zeros((3, 3))
        d[i, j] += 0.5
        d[j, i] += 0.5
        rate = laws.full(flow(law, F + h * d @ F, e, phi)[0] - flow(law, F - h * d @ F, e, phi)[0]) / (2 * h)
        k = laws.full(K)
        np.testing.assert_allclose(laws.full(D[:, :, r]), k * np.trace(d) + rate - d @ k - k @ d, atol=2e-8)


@pytest.mark.parametrize("name", supplies.TYPES)
def test_supplies_at_a_point_among_others(name):
    given = {"Starling": {"kp": 0.4, "pv": 3.0}}[name]
    law, p = supplies.load(name)(**given), np.linspace(1.0, 5.0, N)
    varying.varied(law, N)
    rate, dE, dp = np.zeros(N), np.zeros((N, 6)), np.zeros(N)
    law.supply(at(F, np.arange(N)), p, rate, dE, dp)
    more = np.zeros(N)
    law.supply(at(F, np.arange(N)), p + 1e-6, more, None, None)
    np.testing.assert_allclose((more - rate) / 1e-6, dp, rtol=1e-7)
    for k in range(N):
        one = supplies.load(name)(**given)
        varying.varied(one, N)
        q, d = np.zeros(1), np.zeros(1)
        varying.alone(one, k).supply(at(F[k : k + 1], np.zeros(1, int)), p[k : k + 1], q, None, d)
        np.testing.assert_allclose([rate[k], dp[k]], [q[0], d[0]], rtol=1e-13)
    assert np.ptp(dp) > 1e-3
