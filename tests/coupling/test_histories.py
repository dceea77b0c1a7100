"""Hand-offs: exact for polynomial tissues, rigid motion, overlays, checks."""

import numpy as np
import pytest

from febkit.coupling import check, handoff, overlay, series, surface_nodes
from febkit.coupling.accuracy import cube, handoff_errors, table
from febkit.coupling.checks import gradient
from febkit.coupling.histories import evaluate
from febkit.model import ElementBlock, InputError, Mesh

from .conftest import Polynomial, field, mesh

AT = np.array([0.11, -0.07, 0.05])
X = cube(0.1, 4)


def tissue(kind="hex27", degree=2, n=4):
    u, p = Polynomial(degree, 1), Polynomial(degree, 2, 1)
    return u, p, field(kind, n, u, lambda x: p(x)[:, 0])


HANDED = [("hex27", "element"), ("hex27", "patches"), ("hex20", "polynomial"), ("tet10", "polynomial"),
          ("hex20", None), ("tet10", None), ("hex8", "polynomial")]


@pytest.mark.parametrize(("kind", "recovery"), HANDED)
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_a_tissue_of_degree_n_is_handed_off_exactly_by_order_n(kind, recovery, degree):
    if recovery == "element" and degree == 3:
        pytest.skip("a quadratic element holds no cubic field")
    u, p, f = tissue(kind, degree)
    h = handoff(series(f, AT, order=degree, recovery=recovery), X, order=degree, fluid_order=degree)
    assert np.abs(h.u[1] - (u(X + AT) - u(AT[None]))).max() < 1e-10
    assert np.abs(h.p[1] - p(X + AT)[:, 0]).max() < 1e-10


def test_orders_of_solid_and_fluid_are_apart():
    _, p, f = tissue()
    ds = series(f, AT)
    for order in (1, 2):  # of the pressure: as the solid's where nothing is said
        alike = handoff(ds, X, order=order, fluid_order=order)
        assert np.array_equal(handoff(ds, X, order=order).p, alike.p)
    first = handoff(ds, X, order=1, fluid_order=2)
    assert np.abs(first.p[1] - p(X + AT)[:, 0]).max() < 1e-10
    F = ds["F"].values[0, 1]
    assert np.abs(first.u[1] - X @ (F - np.eye(3)).T).max() < 1e-14


def test_rigid_motion_is_dropped_or_kept():
    """A tissue that turns and moves as it strains: drop-all leaves the right stretch's series."""
    c, s = np.cos(0.4), np.sin(0.4)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    U = np.array([[1.1, 0.05, 0], [0.05, 0.95, 0], [0, 0, 1.02]])
    b = Polynomial(2, 7)

    def place(x):  # R (U x + curvature) + shift
        return (x @ U.T + 0.1 * (b(x) - b(AT[None]))) @ R.T + [0.3, 0.2, -0.1]

    f = field("hex27", 3, lambda x: place(x) - x)
    ds = series(f, AT, recovery="element")
    kept = handoff(ds, X, rigid="keep").u[1]
    assert np.abs(kept - (place(X + AT) - X - AT)).max() < 1e-10
    dropped = handoff(ds, X, rigid="drop").u[1]
    assert np.abs(kept - dropped - (place(AT[None]) - AT)).max() < 1e-12
    bare = handoff(ds, X, rigid="drop-all")
    F = gradient(bare.motion[1:], np.zeros((1, 3)))[0, 0] + np.eye(3)
    assert np.abs(F - F.T).max() < 1e-12
    lengths = [np.linalg.norm(X + u - (X + u)[:1], axis=1) for u in (bare.u[1], dropped)]
    assert np.abs(lengths[0] - lengths[1]).max() < 1e-12
    over = [overlay(f, X, AT, rigid=r).u[1] for r in ("keep", "drop", "drop-all")]
    for got, wanted in zip(over, (kept, dropped, bare.u[1])):
        assert np.abs(got - wanted).max() < 1e-10


def test_an_overlay_is_the_tissues_own_field_and_stays_inside():
    u, p, f = tissue("hex8", 1)
    h = overlay(f, X, AT)
    assert np.abs(h.u[1] - (u(X + AT) - u(AT[None]))).max() < 1e-12
    assert np.abs(h.p[1] - p(X + AT)[:, 0]).max() < 1e-12
    with pytest.raises(InputError, match=r"nodes? outside the tissue.*0\.53"):
        overlay(f, X, [0, 0, 0.48])
    assert handoff(series(f, [0, 0, 0.48]), X).u.shape == (2, len(X), 3)  # the series is what reaches out


def test_the_origin_stands_for_the_point():
    _, _, f = tissue()
    ds = series(f, AT, recovery="element")
    shift = np.array([3.0, -2.0, 1.0])
    moved = handoff(ds, X + shift, origin=shift)
    assert np.abs(moved.u - handoff(ds, X).u).max() < 1e-14
    assert np.abs(overlay(f, X + shift, AT, origin=shift).u - overlay(f, X, AT).u).max() < 1e-14


def test_histories_that_start_late_start_from_rest():
    _, _, f = tissue()
    ds = series(f, AT, times=[0.5, 1.0])
    h = handoff(ds, X)
    assert h.times.tolist() == [0.0, 0.5, 1.0]
    assert not h.u[0].any() and not h.p[0].any()
    assert np.abs(h.u[1] - 0.5 * h.u[2]).max() < 1e-12


def test_checks_say_what_is_wrong():
    u, _, f = tissue("hex27", 3)
    ds = series(f, AT, order=3, recovery="polynomial")
    h = handoff(ds, X)
    found = check(h, ds)
    F = ds["F"].values[0]
    assert found.det_F == pytest.approx((np.linalg.det(F).min(), np.linalg.det(F).max()))
    assert found.size_ratio == pytest.approx(0.1 / 0.25)
    exact = np.abs(h.u[1] - (u(X + AT) - u(AT[None]))).max() / np.abs(h.u[1]).max()
    assert found.remainder_u == pytest.approx(exact, rel=1e-6)  # a cubic field: the order left out is all
    assert not found.problems
    third = check(handoff(ds, X, order=3, fluid_order=3), ds)
    assert 0 < third.remainder_u < found.remainder_u
    big = handoff(ds, X * 60)
    assert check(big, ds).inverted_at is not None
    assert any("inside out" in p for p in check(big, ds).problems)
    assert any("times as large" in p for p in check(big, ds).problems)


def test_the_gradient_of_a_series_agrees_with_differences():
    c = np.random.default_rng(3).normal(size=(2, 20, 3))
    got = gradient(c, X)
    for axis in range(3):
        step = np.eye(3)[axis] * 1e-6
        d = (evaluate(c, X + step) - evaluate(c, X - step)) / 2e-6
        assert np.abs(got[..., axis] - d).max() < 1e-8


@pytest.mark.parametrize(("kind", "n"), [("hex8", 3), ("tet10", 2), ("penta6", 2), ("hex27", 2)])
def test_surface_nodes_are_those_on_the_faces(kind, n):
    nodes, conn = mesh(kind, n)
    m = Mesh(np.arange(1, len(nodes) + 1), nodes, (ElementBlock("a", kind, np.arange(len(conn)) + 1, conn),))
    assert np.array_equal(surface_nodes(m), np.nonzero(np.abs(nodes).max(axis=1) > 0.4999)[0])


def test_wrong_requests_are_refused():
    _, _, f = tissue()
    ds = series(f, AT, order=1)
    with pytest.raises(InputError, match='order 2 asked for, but the driving data hold no "G"'):
        handoff(ds, X, order=2)
    with pytest.raises(InputError, match="rigid motion can be"):
        handoff(ds, X, order=1, rigid="maybe")
    with pytest.raises(InputError, match="order must be"):
        handoff(ds, X, order=5)


def test_the_table_of_errors_shrinks_with_the_elements():
    def smooth(x):
        return 0.1 * np.stack([np.sin(2 * x[:, 1]), np.cos(3 * x[:, 2]), np.sin(3 * x[:, 0] + x[:, 2])], axis=1)

    def flow(x):
        return np.cos(2 * x[:, 2]) + x[:, 0]

    made = {n: field("hex8", n, smooth, flow) for n in (5, 9)}
    errors = handoff_errors(made, field("hex27", 6, smooth, flow), AT, 0.2, [1.0], (1, 2))
    for recovery in ("polynomial", "patches"):
        u = errors["u"].sel(recovery=recovery)
        assert float(u.sel(tissue=9, order=2)) < 0.6 * float(u.sel(tissue=5, order=2))
        assert float(u.sel(tissue=9, order=2)) < 0.5 * float(u.sel(tissue=9, order=1))
    assert len(table(errors).splitlines()) == 1 + 2 * 4


def test_one_order_beyond_estimates_what_is_left_out_and_changes_nothing_else():
    _, _, f = tissue("hex8", 3)
    plain, more = series(f, AT, order=2), series(f, AT, order=2, beyond=True)
    assert "G3" in more and "G3" not in plain and more.attrs["order"] == 2
    for name in ("F", "G", "p", "grad_p", "H"):
        assert np.array_equal(plain[name].values, more[name].values)
    assert check(handoff(more, X), more).remainder_u > 0
