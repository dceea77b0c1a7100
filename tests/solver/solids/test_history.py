"""Solids with memory against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver.points import Points
from febkit.solver.solids import history
from febkit.solver.solids.base import evaluate
from febkit.solver.solids.registry import load


def walk(solid, path, dt):
    """Stresses (steps, 6) of one point led along deformation gradients at equal steps of time."""
    old, out = None, []
    for k, F in enumerate(path, 1):
        pts = Points.at(F[None], t=k * dt, dt=dt, old=old)
        pts.old = history.begin(solid, pts)
        pts.new = pts.old.copy()
        out.append(evaluate(solid, pts, False)[0][0])
        old = pts.new
    return np.array(out)


def neo_hookean():
    return load("solid", "neo-Hookean")(E=2.0, v=0.3)


def held(n, stretch=1.1):
    return [np.diag([stretch, 1.0, 1.0])] * n


def test_step_relaxes_by_the_relaxation_function():
    for name, kw, g in (
        ("relaxation-exponential", {"tau": 0.7}, lambda t: np.exp(-t / 0.7)),
        ("relaxation-power", {"tau": 0.7, "beta": 1.5}, lambda t: (1 + t / 0.7) ** -1.5),
        ("relaxation-Park", {"tau": 0.7, "beta": 1.5}, lambda t: 1 / (1 + (t / 0.7) ** 1.5)),
    ):
        solid = load("solid", "reactive viscoelastic")(
            elastic=neo_hookean(), bond=neo_hookean(), relaxation=load("relaxation", name)(**kw)
        )
        s = walk(solid, held(12), 0.2)
        rest = evaluate(neo_hookean(), Points.at(np.diag([1.1, 1.0, 1.0])[None]), False)[0][0]
        expected = rest[None] * (1.0 + g(0.2 * np.arange(12)))[:, None]
        np.testing.assert_allclose(s, expected, rtol=1e-12, atol=1e-15)


def test_a_generation_begun_in_a_step_stays_though_the_strain_comes_back():
    relaxation = load("relaxation", "relaxation-exponential")(tau=0.7)
    solid = load("solid", "reactive viscoelastic")(
        elastic=neo_hookean(), bond=neo_hookean(), relaxation=relaxation, emin=0.01
    )
    pts = Points.at(np.diag([1.1, 1.0, 1.0])[None], t=0.2, dt=0.2)
    pts.old = history.begin(solid, pts)
    pts.new = pts.old.copy()
    evaluate(solid, pts, False)
    far, near = np.diag([1.1 + 0.02, 1.0, 1.0])[None], np.diag([1.1 + 0.001, 1.0, 1.0])[None]
    later = Points.at(near, t=0.4, dt=0.2, old=history.begin(solid, Points.at(near, old=pts.new)))
    later.new = later.old.copy()
    evaluate(solid, later, False)
    assert later.new[0, 0] == 1.0  # below the threshold
    for F, J in ((far, 1.12), (near, 1.101)):  # two iterations of one step
        later.F, later.J = F, np.array([J])
        evaluate(solid, later, False)
        assert later.new[0, 0] == 2.0


def test_generations_outgrow_their_room():
    relaxation = load("relaxation", "relaxation-exponential")(tau=0.7)
    solid = load("solid", "reactive viscoelastic")(elastic=neo_hookean(), bond=neo_hookean(), relaxation=relaxation)
    n, dt, rate = 40, 0.05, 0.1
    s = walk(solid, [np.diag([1 + rate * dt * k, 1.0, 1.0]) for k in range(1, n + 1)], dt)
    assert solid.capacity >= n
    # small strain: bonds act as a Maxwell element, sigma = E tau rate (1 - exp(-t/tau)) in this step size
    t = dt * np.arange(1, n + 1)
    small = load("solid", "neo-Hookean")(E=2.0, v=0.3)
    modulus = evaluate(small, Points.at(np.eye(3)[None]), True)[1][0, 0, 0]
    maxwell = modulus * rate * (t + 0.7 * (1 - np.exp(-t / 0.7)))
    np.testing.assert_allclose(s[:, 0], maxwell, rtol=0.2)


def test_series_relaxes_to_the_elastic_stress():
    solid = load("solid", "viscoelastic")(elastic=neo_hookean(), g1=0.8, t1=0.5)
    s = walk(solid, held(200), 0.05)
    rest = evaluate(neo_hookean(), Points.at(np.diag([1.1, 1.0, 1.0])[None]), False)[0][0]
    np.testing.assert_allclose(s[-1], rest, rtol=1e-6)
    assert s[0, 0] > 1.6 * rest[0]


def test_damage_keeps_the_largest_strain():
    solid = load("solid", "elastic damage")(
        elastic=neo_hookean(),
        damage=load("cdf", "CDF Weibull")(alpha=2.0, mu=0.2),
        criterion=load("criterion", "DC max normal Lagrange strain")(),
    )
    up, down = np.diag([1.2, 1.0, 1.0]), np.diag([1.05, 1.0, 1.0])
    s = walk(solid, [down, up, down], 1.0)
    E = 0.5 * (1.2**2 - 1)
    intact = np.exp(-((E / 0.2) ** 2))
    free = evaluate(neo_hookean(), Points.at(down[None]), False)[0][0]
    np.testing.assert_allclose(s[2], intact * free, rtol=1e-12, atol=1e-15)
    assert s[0, 0] > s[2, 0]


def _mises(s):
    d = s.copy()
    d[:3] -= s[:3].mean()
    return np.sqrt(1.5 * (d[:3] @ d[:3] + 2 * d[3:] @ d[3:]))


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_perfect_plasticity_stays_on_the_yield_surface(sense):
    solid = load("solid", "reactive plasticity")(
        elastic=neo_hookean(),
        yield_criterion=load("criterion", "DC von Mises stress")(),
        flow_curve=load("flow_curve", "PFC paper")(Y0=0.05, Ymax=0.05, w0=1.0, nf=1),
    )
    path = [np.diag([1 + sense * e, 1 - 0.5 * sense * e, 1 - 0.5 * sense * e]) for e in np.linspace(0.005, 0.1, 20)]
    s = walk(solid, [*path, path[-2]], 0.1)
    for row in s[6:20]:
        assert abs(_mises(row) - 0.05) < 2e-4
    # back by one step is elastic
    drop = _mises(s[19]) - _mises(s[20])
    assert drop == pytest.approx(3 * (2.0 / 2.6) * 0.005, rel=0.1)


def test_flow_curves_of_points_pass_through_them():
    class Response:
        points = ((0.01, 0.02), (0.05, 0.05), (0.2, 0.08))

    Ky, w = load("flow_curve", "PFC user")(plastic_response=Response()).families(Points.at(np.eye(3)[None]))
    E = 0.02 / 0.01
    for strain, stress in Response.points:
        assert sum(w[0, i] * min(E * strain, k) for i, k in enumerate(Ky[0])) == pytest.approx(stress)


def test_a_generation_joins_free_of_stress_where_its_step_starts():
    """Due at t = 1, in the step from 0.5 to 1: from then on the second solid sees F F(0.5)^-1 (FEBio's Update)."""
    gen = load("generation", "generation")
    solid = load("solid", "multigeneration")(
        generation=(gen(0.0, neo_hookean()), gen(1.0, neo_hookean())),
    )
    path = [np.diag([1.0 + 0.1 * k, 1.0, 1.0]) for k in range(1, 5)]
    s = walk(solid, path, 0.5)

    def alone(F):
        return evaluate(neo_hookean(), Points.at(F[None]), False)[0][0]

    np.testing.assert_allclose(s[0], alone(path[0]), rtol=1e-12, atol=1e-15)
    for got, F in zip(s[1:], path[1:], strict=True):
        np.testing.assert_allclose(got, alone(F) + alone(F @ np.linalg.inv(path[0])), rtol=1e-12, atol=1e-15)


def test_a_generation_begun_in_a_step_stays_for_the_step():
    """A first iterate beyond emin starts a generation; the iterates after it move it, but do not take it back."""
    relaxation = load("relaxation", "relaxation-exponential")(tau=0.7)
    solid = load("solid", "reactive viscoelastic")(
        elastic=neo_hookean(), bond=neo_hookean(), relaxation=relaxation, emin=0.01
    )
    far, near = (np.diag([a, 1.0, 1.0])[None] for a in (1.05, 1.001))
    old = history.initial(solid, 1)

    def count(path):
        new = old.copy()
        for F in path:
            pts = Points.at(F, t=0.1, dt=0.1, old=old)
            pts.new = new
            evaluate(solid, pts, False)
        return new[0, 0], new[0, 10 + 5]  # generations; U_xx of the first

    assert count([near]) == (0.0, 0.0)
    assert count([far])[0] == 1.0
    number, U = count([far, near])
    assert number == 1.0
    assert abs(U - 1.001) < 1e-9
