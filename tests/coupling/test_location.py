"""Point location: the element found holds the point, and points outside are named."""

import numpy as np
import pytest

from febkit.coupling import locate, series
from febkit.coupling.field import Field, blocks_of
from febkit.coupling.shapes import outside, shape
from febkit.model import InputError
from febkit.solver import elements

from .conftest import LINEAR, bent, field, grid, skewed


def zero(X):
    return np.zeros_like(X)


@pytest.mark.parametrize("kind", LINEAR)
@pytest.mark.parametrize("warp", [None, skewed, bent], ids=["straight", "skewed", "bent"])
def test_the_natural_coordinates_map_back_to_the_point(kind, warp, places):
    f = field(kind, 3, zero, warp=warp)
    points = places if warp is None else warp(places)
    found = locate(f, points)
    assert found.inside.all()
    b = f.blocks[0]
    back = np.einsum("pn,pni->pi", shape(kind, found.r, 0), f.X[b.conn[found.element]])
    assert np.abs(back - points).max() < 1e-12
    assert outside(kind, found.r).max() < 1e-6


@pytest.mark.parametrize("kind", LINEAR)
def test_points_on_nodes_and_faces_are_inside_and_go_to_the_first_element(kind):
    f = field(kind, 2, zero)
    found = locate(f, f.X)
    assert found.inside.all()
    holders = [[e for e, c in enumerate(f.blocks[0].conn) if i in c] for i in range(len(f.X))]
    assert [min(h) for h in holders] == found.element.tolist()
    assert [len(h) for h in holders] == found.sharing.tolist()


@pytest.mark.parametrize("kind", LINEAR)
def test_points_outside_are_refused_by_coordinates(kind):
    f = field(kind, 2, zero)
    found = locate(f, np.array([[0.5 + 1e-3, 0, 0], [0, 0, 0.5], [9.0, 9, 9]]))
    assert found.inside.tolist() == [False, True, False]
    with pytest.raises(InputError, match=r"1 of 2 points outside the tissue.*\(0\.1, 0\.2, 0\.75\)"):
        series(f, [[0, 0, 0], [0.1, 0.2, 0.75]])


def test_a_large_element_among_small_ones_is_found_from_its_far_corner():
    """A point near the corner of the large middle element is nearer to the centres of small elements."""
    g = np.array([-0.5, -0.44, -0.38, -0.32, 0.32, 0.38, 0.44, 0.5])
    X, conn = grid(len(g) - 1, 0, len(g) - 1)
    X = g[np.round(X).astype(int)]
    f = Field(X, blocks_of(X, [("hex8", conn)]), np.array([0.0]), np.zeros((1, *X.shape)))
    points = np.random.default_rng(1).uniform(-0.5, 0.5, (500, 3))
    found = locate(f, points)
    assert found.inside.all()
    low, high = X[conn].min(axis=1)[found.element], X[conn].max(axis=1)[found.element]
    assert ((points >= low) & (points <= high)).all()


def test_blocks_of_unlike_elements_are_searched_together():
    X, bricks = grid(2)
    left, right = bricks[X[bricks].mean(axis=1)[:, 0] < 0], bricks[X[bricks].mean(axis=1)[:, 0] > 0]
    wedges = np.concatenate([right[:, [0, 1, 2, 4, 5, 6]], right[:, [0, 2, 3, 4, 6, 7]]])
    f = Field(X, blocks_of(X, [("hex8", left), ("penta6", wedges)]), np.array([0.0]), X[None] * 0.5)
    ds = series(f, [[-0.2, 0.1, 0.2], [0.2, 0.1, 0.1]], order=1, recovery="element")
    assert np.abs(ds["F"].values - 1.5 * np.eye(3)).max() < 1e-14
    assert ds["element_id"].values[0] <= len(left) < ds["element_id"].values[1]


def test_every_volume_element_has_a_reference_shape():
    for kind in elements.VOLUMES:
        e = elements.get(kind)
        assert np.abs(outside(kind, e.natural)).max() < 2.1
        assert outside(kind, e.natural).max() <= 1e-12
        assert outside(kind, e.center[None]).max() < 0
