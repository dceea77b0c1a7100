"""Every element by every rule: what shape functions, rules and facets must satisfy."""

from __future__ import annotations

from itertools import product
from math import factorial

import numpy as np
import pytest

from febkit.solver import elements
from febkit.solver.elements.rules import DEGREE, rule

ALL = [*elements.VOLUMES, *elements.FACETS, *elements.LINES, *elements.SHELLS]
EVERY_RULE = [(n, r) for n in ALL for r in elements.get(n).rules]
RNG = np.random.default_rng(11)


def inside(e: elements.Element, n: int = 7) -> np.ndarray:
    """Random natural coordinates inside the element."""
    shell = e.name.startswith("shell")  # corners of the bottom come first, of the top after all bottom nodes
    half = e.corners // 2
    at = [*range(half), *range(e.nodes // 2, e.nodes // 2 + half)] if shell else [*range(e.corners)]
    return RNG.dirichlet(np.ones(e.corners), n) @ e.natural[at]


@pytest.mark.parametrize("name", ALL)
def test_shape_functions_are_one_at_their_node(name: str) -> None:
    e = elements.get(name)
    np.testing.assert_allclose(e.shape(e.natural), np.eye(e.nodes), atol=5e-15)


@pytest.mark.parametrize(("name", "r"), EVERY_RULE)
def test_partition_of_unity(name: str, r: str) -> None:
    e = elements.get(name, r)
    np.testing.assert_allclose(e.N.sum(axis=1), 1.0, atol=1e-14)
    np.testing.assert_allclose(e.dN.sum(axis=1), 0.0, atol=1e-13)


@pytest.mark.parametrize("name", ALL)
def test_gradient_by_finite_difference(name: str) -> None:
    e = elements.get(name)
    x, h = inside(e), 1e-6
    for i in range(e.dim):
        d = np.eye(e.dim)[i] * h
        measured = (e.shape(x + d) - e.shape(x - d)) / (2 * h)
        np.testing.assert_allclose(e.gradient(x)[:, :, i], measured, atol=1e-8)


@pytest.mark.parametrize("name", [n for n in ALL if not n.startswith("pyra")])
def test_polynomials_up_to_the_order_are_met(name: str) -> None:
    e = elements.get(name)
    x = inside(e)
    for powers in product(range(e.order + 1), repeat=e.dim):
        if sum(powers) <= e.order:
            exact = np.prod(x ** np.array(powers), axis=1)
            nodal = np.prod(e.natural ** np.array(powers), axis=1)
            np.testing.assert_allclose(e.shape(x) @ nodal, exact, atol=1e-13)


def moment(kind: str, powers: tuple[int, ...]) -> float:
    """Integral of r^a s^b t^c over the reference shape."""
    line = [2 / (p + 1) if p % 2 == 0 else 0.0 for p in powers]
    simplex = float(np.prod([factorial(p) for p in powers]))
    if kind in ("tri", "tet"):
        return simplex / factorial(sum(powers) + len(powers))
    if kind == "penta":
        return moment("tri", powers[:2]) * line[2]
    return float(np.prod(line))


@pytest.mark.parametrize("name", DEGREE)
def test_rules_are_exact(name: str) -> None:
    kind = name.rstrip("0123456789")
    points, weights = rule(name)
    dim, degree = points.shape[1], DEGREE[name]
    for powers in product(range(degree + 1), repeat=dim):
        if sum(powers) <= degree:
            got = weights @ np.prod(points ** np.array(powers), axis=1)
            assert got == pytest.approx(moment(kind, powers), abs=2e-14)
    beyond = [
        abs(weights @ np.prod(points ** np.array(p), axis=1) - moment(kind, p))
        for p in product(range(degree + 2), repeat=dim) if sum(p) == degree + 1
    ]
    assert max(beyond) > 1e-6  # the degree is the highest


@pytest.mark.parametrize(("name", "r"), EVERY_RULE)
def test_extrapolation(name: str, r: str) -> None:
    """Point values of a constant give it at the nodes; of a linear field too, where the points suffice."""
    e = elements.get(name, r)
    assert e.extrapolation.shape == (e.nodes, e.npoints)
    collapsed = name == "pyra13"  # its 8 points do not carry a constant back through 13 functions
    if e.npoints >= e.corners:
        ones = e.extrapolation @ np.ones(e.npoints)
        if e.npoints >= e.nodes or e.name in ("tet10", "tet15", "tet5", "tet20", "tri10"):
            np.testing.assert_allclose(ones, 1.0, atol=1e-12)
            if not name.startswith("pyra"):
                np.testing.assert_allclose(e.extrapolation @ e.points, e.natural, atol=1e-12)
        else:
            assert collapsed or len(e.rules) > 1


def straight(e: elements.Element) -> np.ndarray:
    """Node positions of the straight-sided element; a pyramid's natural brick is drawn to its apex."""
    x = e.natural.copy()
    if e.name.startswith("pyra"):
        x[:, :2] *= 0.5 * (1.0 - x[:, 2:])
    return x


def bent(e: elements.Element) -> np.ndarray:
    """Node positions of an element bent by a fixed smooth, orientation-keeping map."""
    x = straight(e)
    A = np.array([[1.1, 0.2, -0.1], [0.05, 0.9, 0.15], [0.1, -0.2, 1.2]])
    return x @ A.T + 0.03 * np.column_stack([x[:, 1] * x[:, 2], x[:, 0] * x[:, 2], x[:, 0] * x[:, 1]])


def facet_flux(e: elements.Element, X: np.ndarray) -> float:
    """One third of the flux of x through all facets: the volume, by the divergence theorem."""
    total = 0.0
    for kind, loop in e.facets:
        f = elements.get(kind)
        x = X[list(loop)]
        at, g = f.N @ x, np.einsum("gni,nj->gij", f.dN, x)
        total += float(f.weights @ np.einsum("gi,gi->g", at, np.cross(g[:, 0], g[:, 1]))) / 3
    return total


@pytest.mark.parametrize("name", elements.VOLUMES)
def test_facets_close_and_point_outward(name: str) -> None:
    """Volume of a bent element by its own rule and from its facets agree."""
    e = elements.get(name, "G4") if name == "tet4" else elements.get(name)
    X = bent(e)
    J = np.linalg.det(np.einsum("gni,nj->gji", e.dN, X))
    assert (J > 0).all()
    tolerance = 3e-3 if name in ("tet5", "pyra13") else 1e-12  # bubble, or a rule short of the degree
    assert e.weights @ J == pytest.approx(facet_flux(e, X), rel=tolerance)


@pytest.mark.parametrize("name", [*elements.VOLUMES, *elements.SHELLS])
def test_facet_nodes_carry_the_trace(name: str) -> None:
    """On a facet the element's functions are the facet's own, and all others vanish."""
    e = elements.get(name)
    for kind, loop in e.facets:
        f = elements.get(kind)
        r = inside(f)
        values = e.shape(f.shape(r) @ e.natural[list(loop)])
        if name.startswith("pyra") and kind.startswith("tri"):
            continue  # a collapsed brick: the triangle's coordinates are not the brick's
        expected = np.zeros_like(values)
        expected[:, list(loop)] = f.shape(r)
        np.testing.assert_allclose(values, expected, atol=1e-13)


@pytest.mark.parametrize("name", ALL)
def test_edges(name: str) -> None:
    e = elements.get(name)
    count = {"hex": 12, "tet": 6, "penta": 9, "pyra": 8, "quad": 4, "tri": 3, "line": 1}
    count |= {"shell_quad": 8, "shell_tri": 6}  # those of both faces
    assert len(e.edges) == count[name.rstrip("0123456789")]
    for edge in e.edges:
        if len(edge) == 3:
            x = straight(e)
            np.testing.assert_allclose(x[edge[2]], x[list(edge[:2])].mean(axis=0))


@pytest.mark.parametrize("name", elements.SHELLS)
def test_shells_are_solids_between_two_facets(name: str) -> None:
    """A flat shell of a facet's area times its thickness; the bottom facet is the top's mirror image."""
    e, f = elements.get(name), elements.get(name.removeprefix("shell_"))
    X = e.natural * [1.0, 1.0, 0.05]
    J = np.linalg.det(np.einsum("gni,nj->gji", e.dN, X))
    assert e.weights @ J == pytest.approx(f.weights.sum() * 0.1)
    (_, top), (_, bottom) = e.facets
    assert set(e.natural[list(top), 2]) == {1.0} and set(e.natural[list(bottom), 2]) == {-1.0}
    area = [np.cross(*np.einsum("gni,nj->igj", f.dN, X[list(k)])) for k in (top, bottom)]
    assert (area[0][:, 2] > 0).all() and (area[1][:, 2] < 0).all()


def test_unknown_names_are_refused() -> None:
    with pytest.raises(KeyError, match="no element"):
        elements.get("base")
    with pytest.raises(KeyError, match="no rule"):
        elements.get("hex8", "G99")


def test_element_specs() -> None:
    assert elements.from_spec("TET10G4_S3") == ("tet10", "G4", {"tri6": "G3"})
    assert elements.from_spec("HEX8G1") == ("hex8", "G1", {})
