"""Derivatives by element and by recovery: exact on polynomials, and at the rates they should have."""

import numpy as np
import pytest

from febkit.coupling import RECOVERIES, locate, series
from febkit.coupling.derivatives import COUNT, TERMS, apply, by_element, element_weights, full, packed
from febkit.coupling.polynomial import by_polynomial
from febkit.coupling.shapes import shape
from febkit.model import InputError

from .conftest import LINEAR, Polynomial, bent, field, skewed


@pytest.mark.parametrize("kind", [*LINEAR, "penta15", "tet15", "pyra5"])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_natural_derivatives_agree_with_differences(kind, order):
    r = np.array([[0.21, 0.17, 0.13], [0.1, 0.3, 0.25]])
    h = 1e-5
    got = shape(kind, r, order)
    for axis in range(3):
        step = np.eye(3)[axis] * h
        differences = (shape(kind, r + step, order - 1) - shape(kind, r - step, order - 1)) / (2 * h)
        assert np.abs(got[..., axis] - differences).max() < 1e-8


@pytest.mark.parametrize("kind", LINEAR)
def test_spatial_derivatives_in_bent_elements_agree_with_differences(kind):
    """Through the curvature of the map, up to the third order: the field of the element as a function of X."""
    from febkit.coupling.location import invert

    f = field(kind, 1, Polynomial(3, 3), warp=bent)
    xe = f.X[f.blocks[0].conn[:1]]
    ue = f.u[1][f.blocks[0].conn[0]]
    x0 = np.einsum("n,ni->i", shape(kind, np.array([[0.2, 0.15, 0.1]]), 0)[0], xe[0])

    def derivatives(x, terms):
        r, ok = invert(kind, np.repeat(xe, len(x), axis=0), x)
        assert ok.all()
        return np.einsum("pnk,ni->pki", element_weights(kind, np.repeat(xe, len(x), axis=0), r, terms), ue)

    h = 1e-4
    here = derivatives(x0[None], 20)[0]
    for order in (1, 2, 3):
        for k in range(COUNT[order - 1], COUNT[order]):
            axes = TERMS[k]
            step = np.eye(3)[axes[-1]] * h
            near = derivatives(np.stack([x0 + step, x0 - step]), 20)[:, TERMS.index(axes[:-1])]
            assert np.abs((near[0] - near[1]) / (2 * h) - here[k]).max() < 2e-6


def test_symmetric_tensors_pack_and_unpack():
    values = np.random.default_rng(0).normal(size=(4, 20))
    for order in (1, 2, 3):
        tensor = full(values, order)
        assert np.array_equal(packed(tensor, order), values[:, COUNT[order - 1]:COUNT[order]])
        assert np.array_equal(tensor, np.swapaxes(tensor, -1, -order))


# what each recovery gets exactly: (recovery, element, degree of the field = order)
EXACT = [
    *[("element", k, d) for k in ("hex20", "hex27", "tet10") for d in (1, 2)],
    *[("element", k, 1) for k in LINEAR],
    *[("polynomial", k, d) for k in LINEAR for d in (1, 2, 3)],
    *[("patches", k, d) for k in ("hex20", "hex27", "tet10") for d in (1, 2)],
    *[("patches", k, 3) for k in ("hex20", "hex27")],
    *[("patches", k, 1) for k in LINEAR],
]


@pytest.mark.parametrize(("recovery", "kind", "degree"), EXACT)
def test_polynomial_fields_are_recovered_exactly(recovery, kind, degree, places):
    """A field of degree n: all derivatives up to n to 1e-10, on skewed elements."""
    u, p = Polynomial(degree, 1), Polynomial(degree, 2, 1)
    f = field(kind, 4, u, lambda X: p(X)[:, 0], warp=skewed)
    points = skewed(places)
    ds = series(f, points, order=degree, recovery=recovery)
    for order, (name, fluid) in enumerate(zip(("F", "G", "G3"), ("grad_p", "H", "H3")), 1):
        if order > degree:
            break
        motion, flow = ds[name].values[:, 1], ds[fluid].values[:, 1]
        for axes in TERMS[COUNT[order - 1]:COUNT[order]]:
            wanted = u.derivative(points, axes) + (np.eye(3)[:, axes[0]] if order == 1 else 0.0)
            assert np.abs(motion[(slice(None), slice(None), *axes)] - wanted).max() < 1e-10
            assert np.abs(flow[(slice(None), *axes)] - p.derivative(points, axes)[:, 0]).max() < 1e-10


@pytest.mark.parametrize("kind", ["hex27", "tet10", "hex20"])
def test_a_point_near_the_surface_is_as_exact(kind):
    u = Polynomial(2, 4)
    f = field(kind, 3, u)
    points = np.array([[0.499, 0.499, 0.499], [0.0, 0.0, 0.5], [-0.5, 0.1, 0.2]])
    for recovery in RECOVERIES:
        G = series(f, points, order=2, recovery=recovery)["G"].values[:, 1]
        wanted = np.stack([u.derivative(points, (min(a, b), max(a, b))) for a in range(3) for b in range(3)], axis=-1)
        assert np.abs(G.reshape(3, 3, 9) - wanted).max() < 1e-10


def test_the_pure_second_derivatives_of_a_parallelepiped_are_zero_and_the_text_says_so(places):
    """Along the element's edges, whatever the field; the mixed ones are not."""
    f = field("hex8", 4, Polynomial(3, 6), warp=skewed)
    ds = series(f, skewed(places), order=2, recovery="element")
    edges = skewed(np.eye(3)).T  # columns: the directions of the elements' edges
    along = np.einsum("piJK,Ja,Kb->piab", ds["G"].values[:, 1], edges, edges)
    pure = along[:, :, range(3), range(3)]
    assert np.abs(pure).max() < 1e-11
    assert np.abs(along[:, :, 0, 1]).max() > 0.01
    assert "pure second" in ds.attrs["recovery_text"]


def smooth(X):
    x, y, z = X.T
    return 0.1 * np.stack([np.sin(2 * x + y) * z, np.cos(x - 2 * z) * y, np.exp(x * y) + np.sin(3 * z)], axis=1)


def smooth_second(X):
    """d2/dz2 of the third component, the pure one that linear elements miss."""
    return -0.9 * np.sin(3 * X[:, 2])


def rates(kind, recovery, sizes, degree=None):
    """Observed orders of convergence of F and of one pure second derivative, over random points."""
    points = np.random.default_rng(2).uniform(-0.3, 0.3, (60, 3))
    errors = []
    for n in sizes:
        f = field(kind, n, smooth)
        ds = series(f, points, order=2, recovery=recovery)
        step = 1e-6 * np.eye(3)
        F = np.stack([(smooth(points + s) - smooth(points - s)) / 2e-6 for s in step], axis=-1) + np.eye(3)
        second = ds["G"].values[:, 1, 2, 2, 2] - smooth_second(points)
        errors.append((np.sqrt(((ds["F"].values[:, 1] - F) ** 2).mean()), np.sqrt((second ** 2).mean())))
    e = np.array(errors)
    return np.log(e[:-1] / e[1:]) / np.log(np.array(sizes[1:]) / np.array(sizes[:-1]))[:, None]


@pytest.mark.parametrize("kind", ["hex8", "tet4", "penta6"])
@pytest.mark.parametrize("recovery", ["polynomial", "patches"])
def test_recovered_derivatives_converge_with_linear_elements(kind, recovery):
    """Nodal values are exact here: gradients at second order, second derivatives at first order or better."""
    first, second = rates(kind, recovery, (6, 12))[0]
    assert first > 1.6
    assert second > 0.75


def test_the_elements_own_second_derivative_does_not_converge():
    first, second = rates("hex8", "element", (6, 12))[0]
    assert 0.8 < first < 1.3
    assert abs(second) < 0.05


def test_a_column_one_element_wide_loses_only_what_it_cannot_tell():
    """Confined compression: u_z(z) on a column; x and y have two nodes each."""
    from febkit.coupling.field import Field, blocks_of

    z = np.linspace(0, 1, 11)
    X = np.array([(a, b, c) for c in z for b in (0.0, 0.1) for a in (0.0, 0.1)])
    e = np.arange(10)[:, None] * 4
    conn = e + np.array([0, 1, 3, 2, 4, 5, 7, 6])
    u = np.zeros((1, len(X), 3))
    u[0, :, 2] = 0.3 * X[:, 2] ** 2
    f = Field(X, blocks_of(X, [("hex8", conn)]), np.array([1.0]), u)
    for recovery in ("polynomial", "patches"):
        ds = series(f, [[0.05, 0.04, 0.52]], order=2, recovery=recovery)
        assert ds["G"].values[0, 0, 2, 2, 2] == pytest.approx(0.6, abs=1e-9)
        assert ds["F"].values[0, 0, 2, 2] == pytest.approx(1 + 0.6 * 0.52, abs=1e-9)
        assert int(ds["terms_lost"][0]) > 0


def test_a_patch_keeps_to_its_own_part():
    """A kink at an interface between parts does not leak into the derivatives of either side."""
    from febkit.coupling.field import Block, Field

    from .conftest import grid

    X, conn = grid(8)
    part = (X[conn].mean(axis=1)[:, 2] > 0).astype(np.int64)
    u = np.zeros((1, len(X), 3))
    u[0, :, 2] = np.where(X[:, 2] > 0, 0.3, 0.1) * X[:, 2]
    block = Block("hex8", conn, part, np.arange(len(conn)), np.arange(1, len(conn) + 1))
    f = Field(X, (block,), np.array([1.0]), u)
    points = [[0.01, 0.02, 0.05], [0.01, 0.02, -0.05]]
    for recovery in ("polynomial", "patches"):
        own = series(f, points, order=2, recovery=recovery)
        assert own["F"].values[:, 0, 2, 2] == pytest.approx([1.3, 1.1], abs=1e-12)
        across = series(f, points, order=2, recovery=recovery, own_part=False)
        assert np.abs(across["F"].values[:, 0, 2, 2] - [1.3, 1.1]).max() > 1e-3


def test_rows_are_weights_of_nodes(places):
    f = field("hex8", 4, Polynomial(1))
    where = locate(f, places)
    for rows in (by_element(f, where, 10), by_polynomial(f, where, places, 2)[0]):
        total = np.asarray(rows.sum(axis=1)).reshape(len(places), 10)
        assert np.abs(total[:, 0] - 1).max() < 1e-12  # a constant field has its value and no derivatives
        assert np.abs(total[:, 1:]).max() < 1e-9
        assert apply(rows, f, 10).shape == (len(places), 2, 10, 3)


def test_wrong_requests_are_refused():
    f = field("hex8", 2, Polynomial(1))
    with pytest.raises(InputError, match='no recovery "magic"'):
        series(f, [[0, 0, 0]], recovery="magic")
    with pytest.raises(InputError, match="order must be"):
        series(f, [[0, 0, 0]], order=4)
    with pytest.raises(InputError, match="times 0 to 2 asked for"):
        series(f, [[0, 0, 0]], times=[0, 2])
