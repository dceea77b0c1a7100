"""The table of elements against what else knows elements: the solver's shapes, meshio, geometry."""

from __future__ import annotations

import meshio
import numpy as np
import pytest

from febkit.model.elements import ELEMENTS, corners, of_dimension
from febkit.results.xplt import tags
from febkit.solver import elements
from febkit.templates.facets import FACETS

SOLVED = elements.VOLUMES + elements.FACETS + elements.LINES


@pytest.mark.parametrize("name", SOLVED)
def test_the_solver_has_the_same_elements(name: str) -> None:
    e, shape = ELEMENTS[name], elements.shape(name)
    assert (e.nodes, e.corners, e.dim, e.facets) == (len(shape.nodes), corners(name), shape.dim, shape.facets)
    assert name == f"{e.shape}{e.nodes}"


@pytest.mark.parametrize("name", [n for n in of_dimension(3) if n in SOLVED and not n.startswith("pyra")])
def test_middles_lie_between_corners(name: str) -> None:
    """Each node of a facet after its corners is the mean of two of them, the last maybe of all (natural coordinates of
    pyramids are those of a collapsed brick)."""
    x = np.array(elements.shape(name).nodes, float)
    for kind, loop in ELEMENTS[name].facets:
        c, k = corners(kind), len(loop)
        y = x[list(loop)]
        if k == 3 * c + 1:  # two on each edge, on the last from its end
            ends = np.array([(0, 1), (1, 0), (1, 2), (2, 1), (0, 2), (2, 0)])
            np.testing.assert_allclose(y[c:-1], (2 * y[ends[:, 0]] + y[ends[:, 1]]) / 3, atol=1e-12)
        elif k >= 2 * c:
            np.testing.assert_allclose(y[c : 2 * c], 0.5 * (y[:c] + np.roll(y[:c], -1, axis=0)), atol=1e-12)
        if k % c == 1:
            np.testing.assert_allclose(y[-1], y[:c].mean(axis=0), atol=1e-12)
        n = np.cross(y[1] - y[0], y[2] - y[0])
        assert n @ (y[:c].mean(axis=0) - x[: ELEMENTS[name].corners].mean(axis=0)) > 0  # outward


def test_names_and_numbers_elsewhere() -> None:
    sizes = meshio._mesh.num_nodes_per_cell  # type: ignore[attr-defined]
    assert all(sizes[e.meshio] == e.kept <= e.nodes for e in ELEMENTS.values() if e.meshio)
    codes = [e.code for e in ELEMENTS.values() if e.code is not None]
    assert codes == list(range(20)) and tags.ELEMENT_TYPES[13] == ("penta15", 15)
    whole = [e.meshio for e in ELEMENTS.values() if e.whole]
    assert len(whole) == len(set(whole))


@pytest.mark.parametrize("kind", FACETS)
def test_templates_have_the_facets_bottom_and_top_first(kind: str) -> None:
    assert sorted(FACETS[kind]) == sorted(nodes for _, nodes in ELEMENTS[kind].facets)
    z = np.array(elements.shape(kind).nodes)[list(FACETS[kind][0]), 2]
    assert np.allclose(z, z.min()) and z.min() == min(p[2] for p in elements.shape(kind).nodes)
