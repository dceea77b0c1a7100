"""Strain of shells, and stress and strain at their bottom (back) and top (front) faces."""

from __future__ import annotations

import numpy as np

from .base import AtPoints, Floats, Give, Part, mean, register
from .kinematics import lagrange

BOTTOM, TOP = 0, 1


def levels(part: Part) -> Floats:
    """Natural coordinates of the layers of points through the thickness, from the bottom."""
    return np.unique(np.round(part.g.element.points[:, 2], 12))


def weights(t: Floats, face: int) -> Floats:
    """Lagrange's weights that take values at layers t to a face."""
    at = (-1.0, 1.0)[face]
    return np.array([np.prod([(at - b) / (a - b) for b in t if b != a]) for a in t])


def at_face(points: AtPoints, face: int) -> Give:
    """Extrapolated through the thickness and averaged over the face (m, ...); None of a shell with one layer."""

    def give(part: Part) -> Floats | None:
        values = points(part) if part.group is not None and part.shell else None
        if values is None or len(levels(part)) < 2:
            return None
        own, t = np.round(part.g.element.points[:, 2], 12), levels(part)
        layers = np.stack([values[:, own == level].mean(axis=1) for level in t])
        return np.einsum("l,le...->e...", weights(t, face), layers)

    return give


def at_face_nodes(points: AtPoints, face: int) -> Give:
    """Extrapolated to the nodes of a face (m, n, ...); None of a shell with one layer."""

    def give(part: Part) -> Floats | None:
        values = points(part) if part.group is not None and part.shell else None
        if values is None or len(levels(part)) < 2:
            return None
        to = np.split(part.g.element.extrapolation, 2)[face]
        return np.einsum("ng,eg...->en...", to, values)

    return give


def of_shells(points: AtPoints) -> AtPoints:
    """Nothing for solids."""
    return lambda part: points(part) if part.shell else None


def stress(part: Part) -> Floats | None:
    return part.at_points("stress")


register("shell relative volume", mean(of_shells(lambda part: part.g.J)))
register("shell strain", mean(of_shells(lagrange)))
register("shell top stress", at_face(stress, TOP))
register("shell bottom stress", at_face(stress, BOTTOM))
register("shell top strain", at_face(lagrange, TOP))
register("shell bottom strain", at_face(lagrange, BOTTOM))
register("shell top nodal stress", at_face_nodes(stress, TOP))
register("shell bottom nodal stress", at_face_nodes(stress, BOTTOM))
register("shell top nodal strain", at_face_nodes(lagrange, TOP))
register("shell bottom nodal strain", at_face_nodes(lagrange, BOTTOM))
