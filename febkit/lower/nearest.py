"""How far points are from a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from febkit.model.mesh import Surface
from febkit.solver import elements
from febkit.solver.elements.base import Element

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
OUTSIDE = 0.01  # of a facet's natural coordinates: how far beyond it a point may be projected, as in FEBio
STEPS, CLOSE = 30, 1e-12  # of Newton's method for a projection, and where it ends


def distances(X: Floats, surface: Surface, x: Floats) -> Floats:
    """Distances (n,) of points x (n, 3) from a surface of a mesh with nodes X: along normals of the facets around, else
    from their edges and corners."""
    out = np.full(len(x), np.inf)
    for kind, conn in surface.facets.items():
        e = elements.get(kind)
        point, facet = _pairs(X, conn, x)
        corners, at = X[conn[facet]], x[point]
        d, inside = _along_normal(e, corners, at)
        d = np.where(inside, d, _from_edges(corners[:, : e.corners], at))
        np.minimum.at(out, point, d)
    return out


def _pairs(X: Floats, conn: Ints, x: Floats) -> tuple[Ints, Ints]:
    """Points and facets to be tried: those around the nearest node, and around the nodes of these."""
    from scipy.sparse import coo_array
    from scipy.spatial import cKDTree

    nodes, local = np.unique(conn, return_inverse=True)
    local = local.reshape(conn.shape)
    rows = np.repeat(np.arange(len(conn)), conn.shape[1])
    has = coo_array((np.ones(conn.size), (rows, local.ravel())), (len(conn), len(nodes))).tocsr()
    around = (has.T @ has @ has.T).tocsr()  # node, facet
    nearest = cKDTree(X[nodes]).query(x)[1]
    tried = around[nearest].tocoo()
    return tried.row.astype(np.int64), tried.col.astype(np.int64)


def _along_normal(e: Element, X: Floats, x: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Distances of points (q, 3) from facets (q, n, 3) along their normals; does the foot lie on the facet?"""
    r = np.tile(e.center.astype(float), (len(x), 1))
    for _ in range(STEPS):
        gap = x - np.einsum("qn,qni->qi", e.shape(r), X)
        t = np.einsum("qna,qni->qai", e.gradient(r), X)
        metric = np.einsum("qai,qbi->qab", t, t)
        step = np.linalg.solve(metric, np.einsum("qai,qi->qa", t, gap)[..., None])[..., 0]
        r = np.clip(r + step, -5.0, 5.0)  # a foot far outside is none
        if np.abs(step).max() < CLOSE:
            break
    gap = x - np.einsum("qn,qni->qi", e.shape(r), X)
    if e.corners == 4:
        inside = (np.abs(r) <= 1.0 + OUTSIDE).all(axis=1)
    else:
        inside = (r >= -OUTSIDE).all(axis=1) & (r.sum(axis=1) <= 1.0 + OUTSIDE)
    return np.linalg.norm(gap, axis=1), inside


def _from_edges(X: Floats, x: Floats) -> Floats:
    """Distances of points (q, 3) from the edges of polygons (q, n, 3)."""
    a, along = X, np.roll(X, -1, axis=1) - X
    s = np.einsum("qni,qni->qn", along, x[:, None] - a) / np.einsum("qni,qni->qn", along, along)
    foot = a + np.clip(s, 0.0, 1.0)[..., None] * along
    return np.asarray(np.linalg.norm(x[:, None] - foot, axis=2).min(axis=1))
