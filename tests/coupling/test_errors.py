"""What the tissue alone tells of a hand-off's error: exact where the next order is all, of the right rate elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from febkit.coupling import check, errors, estimate, handoff, series
from febkit.coupling.derivatives import COUNT, TERMS, gradient, monomials
from febkit.model import InputError

from .conftest import Polynomial, field

AT = np.array([0.06, -0.03, 0.02])
EDGE = 0.2


def largest(coefficient: np.ndarray, order: int) -> float:
    """Largest norm over the box of the terms of one order of a polynomial's series at the point."""
    terms = slice(COUNT[order - 1], COUNT[order])
    values = monomials(errors.lattice(EDGE))[:, terms] @ coefficient[terms]
    return float(np.linalg.norm(values, axis=1).max())


def at_the_point(f: Polynomial) -> np.ndarray:
    return np.stack([f.derivative(AT[None], t)[0] for t in TERMS])


@pytest.mark.parametrize("order", [1, 2])
def test_the_next_term_is_the_truncation_where_it_is_all_that_is_left_out(order):
    u, p = Polynomial(order + 1, 1), Polynomial(order + 1, 2, 1)
    f = field("hex20", 3, u, lambda X: p(X)[:, 0])
    ds = series(f, AT, order=order, box=EDGE)
    found, of_u, of_p = estimate(ds, 0, order, order), at_the_point(u), at_the_point(p)
    parts = found["u_error_by_part"].sel(part="truncation")
    assert parts.values == pytest.approx([0.0, largest(of_u, order + 1)], rel=1e-6, abs=1e-12)
    slope = found["grad_p_error_by_part"].sel(part="truncation")
    lattice = errors.lattice(EDGE)
    own = np.zeros((1, COUNT[order + 1], 1))
    own[0, COUNT[order]:] = of_p[COUNT[order]:COUNT[order + 1]]
    assert float(slope[-1]) == pytest.approx(np.linalg.norm(gradient(own, lattice)[0, :, 0], axis=1).max(), rel=1e-6)
    # and it is what the hand-off is off by
    given = handoff(ds, lattice, order=order, fluid_order=order)
    true = np.linalg.norm(given.u[1] - (u(lattice + AT) - u(AT[None])), axis=1).max()
    assert true == pytest.approx(largest(of_u, order + 1), rel=1e-6)


def test_the_estimate_is_the_error_where_the_tissue_has_the_field():
    """A quadratic field in quadratic elements, handed off by its linear part."""
    u, p = Polynomial(2, 1), Polynomial(2, 2, 1)
    found = estimate(series(field("hex20", 3, u, lambda X: p(X)[:, 0]), AT, order=1, box=EDGE), 0, 1)
    assert found["u_error"].values == pytest.approx([0.0, largest(at_the_point(u), 2)], rel=1e-6)
    assert found["p_error"].values == pytest.approx([0.0, largest(at_the_point(p), 2)], rel=1e-6)


def test_a_strain_is_off_by_the_gradient_that_is_left_out():
    def u(X):
        return 0.1 * np.stack([0 * X[:, 0], 0 * X[:, 0], X[:, 2] ** 2], axis=1)

    found = estimate(series(field("hex20", 3, u), [0, 0, 0.0], order=1, recovery="polynomial", box=EDGE), 0, 1)
    top = 0.2 * EDGE / 2  # du_z/dz at the box's end
    assert found["strain_error"].values[-1] == pytest.approx(top + top**2 / 2, rel=1e-6)
    assert found["strain_scale"].values[-1] == pytest.approx(top + top**2 / 2, rel=1e-6)
    assert "p_error" not in found and "modulus" not in found and "permeability" not in found


def smooth(X):
    return 0.1 * np.stack([np.sin(2 * X[:, 1]), np.cos(3 * X[:, 2]), np.sin(3 * X[:, 0] + X[:, 2])], axis=1)


def flow(X):
    return np.cos(2 * X[:, 2]) + X[:, 0] ** 2


@pytest.mark.parametrize("order", [1, 2])
def test_truncation_falls_with_the_box_as_the_order_says(order):
    f = field("hex20", 3, smooth, flow)
    at = [series(f, AT, order=order, box=edge) for edge in (0.2, 0.1)]
    for name, rate in (("u", order + 1), ("strain", order), ("grad_p", order)):
        parts = [estimate(ds, 0, order, order)[f"{name}_error_by_part"].sel(part="truncation") for ds in at]
        assert np.log2(float(parts[0][-1] / parts[1][-1])) == pytest.approx(rate, abs=0.1), name


def test_the_part_of_the_mesh_falls_with_the_square_of_its_elements():
    h = {n: estimate(series(field("hex8", n, smooth, flow), AT, box=0.05))["p_error_by_part"].sel(part="mesh")[-1]
         for n in (9, 18)}
    assert np.log2(float(h[9] / h[18])) == pytest.approx(2.0, abs=0.3)
    # h^2/12 lap p, at the box's middle
    lap = -4 * np.cos(2 * AT[2]) + 2
    assert float(h[18]) == pytest.approx(abs(lap) / 12 / 18**2, rel=0.2)


@pytest.mark.parametrize("kind", ["hex8", "tet4", "hex20"])
def test_estimates_come_near_the_error(kind):
    f = field(kind, 8, smooth, flow)
    X = errors.lattice(EDGE)
    for order, most in ((1, 2), (2, 8)):  # nodal values are exact here, which the part of the mesh does not know
        ds = series(f, AT, order=order, box=EDGE)
        given, found = handoff(ds, X, order=order), estimate(ds, 0, order)
        true = np.linalg.norm(given.u[1] - (smooth(X + AT) - smooth(AT[None])), axis=1).max()
        assert 0.7 < float(found["u_error"][-1]) / true < most
        assert 0.7 < float(found["p_error"][-1]) / np.abs(given.p[1] - flow(X + AT)).max() < most


def test_pressure_that_swings_from_node_to_node_shows():
    def swinging(X):
        return flow(X) + 0.1 * (-1.0) ** np.round(8 * (X[:, 2] + 0.5))

    calm, wild = (estimate(series(field("hex8", 8, smooth, p), AT, box=EDGE)) for p in (flow, swinging))
    swing = wild["p_error_by_part"].sel(part="swing")
    assert 0.08 < float(swing[-1]) < 0.3 and float(calm["p_error_by_part"].sel(part="swing")[-1]) < 0.01
    assert float(wild["p_error"][-1]) > float(calm["p_error"][-1]) + 0.02
    f = field("hex8", 8, smooth, swinging)
    ds = series(f, AT, box=EDGE)
    assert "pressure swings from node to node" in "".join(check(handoff(ds, errors.lattice(EDGE)), ds).lines)


def test_auto_takes_the_order_that_the_field_has():
    """A linear field where a coarse mesh swings wants few terms; a smooth one all of them."""
    X = errors.lattice(EDGE)
    ds = series(field("hex20", 4, Polynomial(3, 4), flow), [AT, -AT], order="auto", box=EDGE)
    assert ds["solid_order"].values.tolist() == [3, 3] and ds.attrs["order"] == "auto"
    given = handoff(ds, X, order="auto")
    assert given.text.startswith("order 3 for the solid")
    for n in (1, 2, 3):  # coefficients are those of a series of the order chosen
        found = estimate(ds, 1, n)
        assert float(estimate(ds, 1, 3)["strain_error"][-1]) <= float(found["strain_error"][-1])
    again = handoff(series(field("hex20", 4, Polynomial(3, 4), flow), [AT, -AT], order=3), X, order=3,
                    fluid_order=int(ds["fluid_order"][0]))
    assert np.allclose(again.u, given.u, rtol=0, atol=1e-14)


def test_a_field_of_noise_is_handed_off_by_its_lowest_order():
    rng = np.random.default_rng(3)
    noise: dict[int, np.ndarray] = {}

    def u(X):
        return noise.setdefault(len(X), 0.01 * rng.normal(size=X.shape))

    def line(X):
        return np.stack([0.1 * X[:, 2], 0 * X[:, 0], 0 * X[:, 0]], axis=1) + u(X)

    ds = series(field("hex8", 12, line, lambda X: X[:, 2] + u(X)[:, 0]), AT, order="auto", box=EDGE,
                recovery="polynomial")
    assert int(ds["solid_order"][0]) < 3 and int(ds["fluid_order"][0]) < 3
    own = series(field("hex8", 12, line, lambda X: X[:, 2] + u(X)[:, 0]), AT, order=int(ds["solid_order"][0]),
                 recovery="polynomial")
    assert np.array_equal(ds["F"].values, own["F"].values)


def test_a_box_that_sticks_out_of_the_tissue_counts_inside():
    f = field("hex8", 6, smooth, flow)
    found = estimate(series(f, [0, 0, 0.45], box=EDGE))
    assert np.isfinite(found["u_error"].values).all() and float(found["u_error"][-1]) > 0


def test_the_balances_give_modulus_and_permeability():
    """u_z = t (a z^2 + b z^3), p_z = H u_zz, and d(u_z,z)/dt = k p_zz: a tissue that drains along z."""
    a, b, H, k = 0.05, 0.3, 1.7, 0.02

    def u(X):
        return np.stack([0 * X[:, 0], 0 * X[:, 0], a * X[:, 2] ** 2 + b * X[:, 2] ** 3], axis=1)

    f = field("hex20", 2, u, lambda X: H * (2 * a * X[:, 2] + 3 * b * X[:, 2] ** 2), times=(0.0, 1.0))
    assert float(series(f, [0, 0, 0.0], box=EDGE)["modulus"][0]) == pytest.approx(H, rel=1e-6)

    def swell(X):  # its rate 2 a z is k times the Laplacian of a z^3 / 3 k
        return np.stack([0 * X[:, 0], 0 * X[:, 0], a * X[:, 2] ** 2], axis=1)

    f = field("hex20", 2, swell, lambda X: a / k * X[:, 2] ** 3 / 3, times=(0.0, 1.0))
    steady = replace(f, p=np.repeat(f.p[1:], 2, axis=0))
    assert float(series(steady, [0, 0, 0.0], box=EDGE)["permeability"][0]) == pytest.approx(k, rel=1e-6)


def test_checks_print_it():
    f = field("hex8", 6, smooth, flow)
    ds = series(f, AT, box=EDGE)
    lines = [s for s in check(handoff(ds, errors.lattice(EDGE)), ds).lines if "error" in s or "mesh" in s]
    assert len(lines) == 2 and lines[0].startswith("estimated error") and "its gradient" in lines[0]
    plain = series(f, AT)
    assert not [s for s in check(handoff(plain, errors.lattice(EDGE)), plain).lines if "estimated" in s]


def test_wrong_requests_are_refused():
    f = field("hex8", 3, smooth, flow)
    with pytest.raises(InputError, match="asks for the size of the cell model"):
        series(f, AT, order="auto")
    with pytest.raises(InputError, match='1, 2, 3 or "auto"'):
        series(f, AT, order="most")
    with pytest.raises(InputError, match="no orders were chosen"):
        handoff(series(f, AT), errors.lattice(EDGE), order="auto")
    with pytest.raises(InputError, match="no estimate of their error"):
        estimate(series(f, AT))
    for box in (0.0, -1.0, [[0.0, 0, 0]], [1.0, 2, 3], float("nan")):
        with pytest.raises(InputError, match="edge of a cube"):
            series(f, AT, box=box)
