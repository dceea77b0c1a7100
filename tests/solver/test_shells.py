"""Back faces of shells: directors, volumes, and solids attached to them."""

from __future__ import annotations

import numpy as np
import pytest

from febkit.solver import elements
from febkit.solver.shells import Shell, Solid, directors, thicken


def sphere(n: int = 24) -> tuple[np.ndarray, np.ndarray]:
    """Part of the unit sphere meshed by quadrilaterals whose normals point outward."""
    a, b = np.meshgrid(np.linspace(0.0, 0.6, n + 1), np.linspace(-0.3, 0.3, n + 1), indexing="ij")
    X = np.column_stack([
        (np.cos(b) * np.cos(a)).ravel(), (np.cos(b) * np.sin(a)).ravel(), np.sin(b).ravel()
    ])
    i, j = (q.ravel() for q in np.meshgrid(range(n), range(n), indexing="ij"))
    k = i * (n + 1) + j
    return X, np.column_stack([k, k + n + 1, k + n + 2, k + 1])


def test_directors_of_a_sphere_are_radial() -> None:
    X, conn = sphere()
    D, has = directors(X, [Shell("quad4", conn, np.full(conn.shape, 0.1))])
    assert has.all()
    np.testing.assert_allclose(D, 0.1 * X, atol=2e-3)


@pytest.mark.parametrize(("facet", "h"), [("quad4", 0.2), ("quad8", 0.2), ("tri3", 0.2), ("tri6", 0.2)])
def test_a_flat_shell_is_area_times_thickness(facet: str, h: float) -> None:
    f = elements.get(facet)
    X = np.column_stack([f.natural, np.zeros(f.nodes)])
    t = thicken(X, [Shell(facet, np.arange(f.nodes)[None], np.full((1, f.nodes), h))])
    np.testing.assert_allclose(t.X[t.back], X - [0, 0, h], atol=1e-15)
    e = elements.get(f"shell_{facet}")
    J = np.linalg.det(np.einsum("gni,nj->gji", e.dN, t.X[t.shells[0][0]]))
    assert (J > 0).all() and e.weights @ J == pytest.approx(f.weights.sum() * h)


def test_thickness_and_normals_are_averaged() -> None:
    """Two shells at a right angle: the shared nodes take the mean of both directors."""
    X = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (0, 1, 1)], dtype=float)
    conn = np.array([(0, 1, 2, 3), (0, 3, 5, 4)])
    D, has = directors(X, [Shell("quad4", conn, np.array([[0.2] * 4, [0.4] * 4]))])
    assert has.all()
    np.testing.assert_allclose(D[0], [0.2, 0.0, 0.1])
    np.testing.assert_allclose(D[[1, 5]], [[0, 0, 0.2], [0.4, 0, 0]])


def test_solids_hang_on_the_side_they_are_on() -> None:
    """A brick below a shell takes its back nodes, one above keeps the mesh's."""
    e = elements.get("hex8")
    unit = 0.5 * (1.0 + e.natural)
    below, above = unit - np.array([0, 0, 1]), unit
    X = np.vstack([below, above[4:]])
    low, high = np.arange(8)[None], np.array([[4, 5, 6, 7, 8, 9, 10, 11]])
    shell = Shell("quad4", np.array([[4, 5, 6, 7]]), np.full((1, 4), 0.1))
    t = thicken(X, [shell], [Solid("hex8", low), Solid("hex8", high)])
    assert len(t.X) == 16 and (t.back[4:8] == [12, 13, 14, 15]).all() and (t.back[:4] == -1).all()
    np.testing.assert_array_equal(t.solids[0], [[0, 1, 2, 3, 12, 13, 14, 15]])
    np.testing.assert_array_equal(t.solids[1], high)
    np.testing.assert_array_equal(t.shells[0], [[12, 13, 14, 15, 4, 5, 6, 7]])
    flipped = Shell("quad4", shell.conn[:, ::-1], shell.thickness)
    t = thicken(X, [flipped], [Solid("hex8", low), Solid("hex8", high)])
    np.testing.assert_array_equal(t.solids[0], low)
    np.testing.assert_array_equal(np.sort(t.solids[1][0]), [8, 9, 10, 11, 12, 13, 14, 15])


def test_elements_that_touch_an_edge_follow() -> None:
    """A second brick of the part below, sharing only an edge with the shell, moves to the back nodes too."""
    X = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1, 2)], dtype=float)
    conn = np.array([(0, 1, 4, 3, 6, 7, 10, 9), (1, 2, 5, 4, 7, 8, 11, 10)])
    shell = Shell("quad4", np.array([[6, 7, 10, 9]]), np.full((1, 4), 0.1))
    t = thicken(X, [shell], [Solid("hex8", conn)])
    back = t.back[[6, 7, 10, 9]]
    np.testing.assert_array_equal(t.solids[0], [[0, 1, 4, 3, *back], [1, 2, 5, 4, back[1], 8, 11, back[2]]])


def test_no_thickness_is_refused() -> None:
    X, conn = sphere(2)
    with pytest.raises(ValueError, match="thickness"):
        thicken(X, [Shell("quad4", conn, np.zeros(conn.shape))])
