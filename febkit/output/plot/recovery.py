"""Values recovered at the nodes of solid parts: superconvergent patches, and what averaging differs from.

Zienkiewicz & Zhu, Int. J. Numer. Methods Eng. 33 (1992) 1331: a polynomial is fitted to the values at the points of the
elements around each corner node. As in FEBio 4.11: its terms are 1 x y z (tetrahedra), with xy yz xz (hex8), with xx yy
zz too (elements of second order); where too few points are around a node, a neighbour's polynomial gives its value; the
other nodes of elements of second order take the mean of the polynomials around.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .base import AtPoints, Floats, Give, Part, full, register, shared
from .kinematics import infinitesimal, lagrange
from .motion import position

TERMS = {"tet4": 4, "tet5": 4, "tet10": 10, "tet15": 10, "tet20": 10, "hex8": 7, "hex20": 10, "hex27": 10}
LINEAR = {"tet10": 4, "tet15": 4, "hex20": 7, "hex27": 7}
CORNERS = {"tet": 4, "hex": 8}


def basis(r: Floats, n: int) -> Floats:
    """The first n of 1 x y z xy yz xz xx yy zz at r (..., 3)."""
    x, y, z = np.moveaxis(r, -1, 0)
    return np.stack([np.ones_like(x), x, y, z, x * y, y * z, x * z, x * x, y * y, z * z][:n], axis=-1)


def patches(part: Part, values: Floats, order: int = 0) -> Floats | None:
    """Values (m, g, k) at the nodes of the part, in the order of its nodes (node, k)."""
    kind = part.g.element.name
    terms = (LINEAR if order == 1 else TERMS).get(kind, TERMS.get(kind, 0))
    if not terms:
        return np.zeros((len(part.mesh.nodes()), values.shape[-1]))
    return _Patches(part, terms).project(values)


class _Patches:
    """Patches around the corner nodes of a part, in the order in which FEBio meets them."""

    def __init__(self, part: Part, terms: int) -> None:
        self.terms, self.nodes = terms, part.mesh.nodes()
        self.x, self.points = part.state.x, position(part)
        self.conn = np.asarray(part.mesh.conn)
        corners = CORNERS[part.g.element.name[:3]]
        self.corner = np.zeros(int(self.nodes.max()) + 1, bool)
        self.corner[self.conn[:, :corners]] = True
        self.corner[self.conn[:, corners:]] = False
        order = np.argsort(self.conn.ravel(), kind="stable")
        sizes = np.bincount(self.conn.ravel(), minlength=len(self.corner))
        self.around = np.split(order // self.conn.shape[1], np.cumsum(sizes)[:-1])

    def project(self, values: Floats) -> Floats:
        tag = np.zeros(len(self.corner), np.int64)
        tag[~self.corner] = 2  # counts visits from here
        out = np.zeros((len(self.corner), values.shape[-1]))
        for n in self.nodes[self.corner[self.nodes]]:
            elements = self.around[n]
            p = basis(self.points[elements] - self.x[n], self.terms).reshape(-1, self.terms)
            if len(p) <= self.terms + 1:
                continue
            v = values[elements].reshape(len(p), -1)
            c = np.linalg.solve(p.T @ p, p.T @ v)
            tag[n], out[n] = 1, c[0]
            for e in elements:
                self._neighbours(n, self.conn[e], c, tag, out)
        several = tag > 2
        out[several] /= (tag[several] - 2)[:, None]
        return out[self.nodes]

    def _neighbours(self, n: int, nodes: Any, c: Floats, tag: Any, out: Floats) -> None:
        """Values of a polynomial at nodes of an element that have none of their own."""
        some = nodes[tag[nodes] != 1]
        if not len(some):
            return
        v = basis(self.x[some] - self.x[n], self.terms) @ c
        counted = tag[some] >= 2
        out[some[counted]] += v[counted]
        tag[some[counted]] += 1
        out[some[~counted]] = v[~counted]


def recovered(points: AtPoints, order: int = 0) -> Give:
    """Values at points recovered at the nodes of solid parts (node, ...)."""

    def give(part: Part) -> Floats | None:
        v = points(part) if part.group is not None and not part.shell else None
        return None if v is None else patches(part, v.reshape(*v.shape[:2], -1), order)

    return give


def stress(part: Part) -> Floats | None:
    """Stress (m, g, 6)."""
    return part.at_points("stress")


@shared
def principal(part: Part) -> Floats | None:
    """Principal stresses, largest first (m, g, 3)."""
    s = stress(part)
    return None if s is None else np.asarray(np.linalg.eigvalsh(full(s))[..., ::-1], float)


def error(part: Part) -> Floats | None:
    """The largest difference, over the points of each element, between the von Mises stress and what its nodal means
    interpolate to, relative to the range of the former in the part (m,)."""
    s = stress(part) if part.group is not None else None
    if s is None:
        return None
    x, y, z, xy, yz, xz = np.moveaxis(s, -1, 0)
    v = np.sqrt(np.maximum(x * x + y * y + z * z - x * y - y * z - x * z + 3 * (xy * xy + yz * yz + xz * xz), 0.0))
    e, conn = part.g.element, part.g.conn
    count = np.bincount(conn.ravel())
    nodal = np.bincount(conn.ravel(), (v @ e.extrapolation.T).ravel()) / np.maximum(count, 1)
    span = float(np.ptp(v))
    there = nodal[conn] @ e.N.T
    return np.abs(v - there).max(axis=1) / (span if span >= 1e-12 else span + 1.0)


register("SPR stress", recovered(stress))
register("SPR-P1 stress", recovered(stress, 1))
register("SPR principal stress", recovered(principal))
register("SPR Lagrange strain", recovered(lagrange))
register("SPR infinitesimal strain", recovered(infinitesimal))
register("SPR relative volume", recovered(lambda part: part.g.J[..., None]))
register("stress error", error)
