"""Local material axes and fiber directions: generators from positions, nodes, angles and element data.

Each record is called with points and gives (1|n, 3, 3) axes as columns, or (1|n, 3) directions. The local
axes of FEBio's ``mat_axis`` and the directions of ``fiber`` have generators of the same names, which
differ in what they return.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..points import Points
from ..record import record
from ..values import as_value
from .base import Floats, Number

_X, _Y, _Z = np.eye(3)


class Steady:
    """Axes or directions that depend on places alone, unless it says otherwise."""

    __slots__ = ()
    steady = True


def unit(v: ArrayLike) -> Floats:
    """Vectors (..., 3) divided by their lengths; zero vectors stay zero."""
    a = np.asarray(v, dtype=float)
    l = np.linalg.norm(a, axis=-1, keepdims=True)
    return a / np.where(l == 0, 1.0, l)


def frame(a: ArrayLike, d: ArrayLike) -> Floats:
    """Axes (..., 3, 3) with first column along a, third along a x d, second to complete them."""
    a, d = np.broadcast_arrays(np.asarray(a, dtype=float), np.asarray(d, dtype=float))
    c = np.cross(a, d)
    return np.stack((unit(a), unit(np.cross(c, a)), unit(c)), axis=-1)


def turn(v: ArrayLike, start: ArrayLike, end: ArrayLike) -> Floats:
    """``v`` under the shortest rotation that takes the unit vector ``start`` to ``end``.

    Where the two are opposite the rotation has no axis and ``v`` stays as it is.
    """
    v, a, b = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (v, start, end)))
    n = unit(np.cross(a, b))
    cos = np.clip((a * b).sum(-1, keepdims=True), -1.0, 1.0)
    half = np.sqrt(0.5 * (1.0 + cos))
    q = n * np.sqrt(0.5 * (1.0 - cos))
    t = 2.0 * np.cross(q, v)
    still = (half == 0) | (np.abs(q).sum(-1, keepdims=True) == 0)
    return np.where(still, v, v + half * t + np.cross(q, t))


@record
class FixedAxes(Steady):
    """Axes (1, 3, 3) or (n_elements, 3, 3), one for each element of the block."""

    Q: Floats

    def __call__(self, pts: Points) -> Floats:
        return self.Q if len(self.Q) == 1 else self.Q[pts.e]


def vector_axes(a: ArrayLike = _X, d: ArrayLike = _Y) -> FixedAxes:
    """``mat_axis type="vector"``: a along the first axis, d in the plane of the first two."""
    a, d = unit(a), unit(d)
    if abs(a @ d) > 0.999:
        d = _X if abs(a @ _X) <= 0.999 else _Y
    return FixedAxes(frame(a, d)[None])


def element_axes(a: ArrayLike, d: ArrayLike) -> FixedAxes:
    """Axes of each element from vectors a and d (n_elements, 3): element data ``mat_axis``."""
    return FixedAxes(frame(unit(a), unit(d)))


def local_axes(X: Floats, nodes: tuple[int, int, int] = (0, 0, 0)) -> FixedAxes:
    """``mat_axis type="local"``: through element nodes; ``X`` (n_elements, n_nodes, 3), ``nodes`` 1-based."""
    n1, n2, n3 = nodes if any(k > 0 for k in nodes) else (1, 2, 4)
    n3 = n3 if n3 > 0 else n2
    a = unit(X[:, n2 - 1] - X[:, n1 - 1])
    if n3 != n2:
        return FixedAxes(frame(a, X[:, n3 - 1] - X[:, n1 - 1]))
    d = np.where(np.abs(a[:, 1:2]) > 0.999, _X, _Y)
    return FixedAxes(frame(a, d))


@record
class SphericalAxes(Steady):
    """``mat_axis type="spherical"``: ``vector`` turned with the radius from ``center``."""

    center: ArrayLike = (0.0, 0.0, 0.0)
    vector: ArrayLike = (1.0, 0.0, 0.0)

    def __call__(self, pts: Points) -> Floats:
        a = turn(unit(self.vector), _X, unit(pts.X - np.asarray(self.center)))
        d = np.where(np.abs(a[:, 1:2]) > 0.99, _Z, _Y)
        return frame(a, d)


def _radius(X: Floats, center: ArrayLike, axis: ArrayLike) -> tuple[Floats, Floats]:
    """Unit vector from the axis to each position, and the distance."""
    a = unit(axis)
    p = X - np.asarray(center)
    b = p - a * (p @ a)[:, None]
    return unit(b), np.linalg.norm(b, axis=1)


def _around(v: Floats, b: Floats) -> Floats:
    d = turn(_Y, _X, b)
    d = np.where(np.abs((d * v).sum(1, keepdims=True)) > 0.99, turn(_Z, _X, b), d)
    return frame(v, d)


@record
class CylindricalAxes(Steady):
    """``mat_axis type="cylindrical"``: ``vector`` turned with the radius from the ``axis`` through ``center``."""

    center: ArrayLike = (0.0, 0.0, 0.0)
    axis: ArrayLike = (0.0, 0.0, 1.0)
    vector: ArrayLike = (1.0, 0.0, 0.0)

    def __call__(self, pts: Points) -> Floats:
        b, _ = _radius(pts.X, self.center, self.axis)
        return _around(turn(unit(self.vector), _X, b), b)


@record
class PolarAxes(Steady):
    """``mat_axis type="polar"``: ``vector1`` at ``radius1`` to ``vector2`` at ``radius2``, turned with the radius."""

    center: ArrayLike = (0.0, 0.0, 0.0)
    axis: ArrayLike = (0.0, 0.0, 1.0)
    vector1: ArrayLike = (1.0, 0.0, 0.0)
    vector2: ArrayLike = (1.0, 0.0, 0.0)
    radius1: float = 0.0
    radius2: float = 1.0

    def __call__(self, pts: Points) -> Floats:
        b, R = _radius(pts.X, self.center, self.axis)
        v1, v2 = unit(self.vector1), unit(self.vector2)
        span = self.radius2 - self.radius1 or 1.0
        w = ((R - self.radius1) / span)[:, None]
        cos = float(np.clip(v1 @ v2, -1.0, 1.0))
        half = np.sqrt(0.5 * (1.0 + cos))
        axis = unit(np.cross(v1, v2))
        if half < 0.95:
            angle = np.arccos(half)
            q0, qn = np.sin(angle * (1.0 - w)) + half * np.sin(angle * w), np.sin(angle) * np.sin(angle * w)
            q0, qn = q0 / np.sin(angle), qn / np.sin(angle)
        else:
            q0, qn = (1.0 - w) + half * w, np.sqrt(0.5 * (1.0 - cos)) * w
        q = qn * axis
        t = 2.0 * np.cross(q, v1)
        return _around(turn(v1 + q0 * t + np.cross(q, t), _X, b), b)


@record
class AngleAxes:
    """``mat_axis type="angles"``: spherical angles in degrees of the first axis, ``phi`` from z."""

    theta: Number = 0.0
    phi: Number = 90.0

    @property
    def steady(self) -> bool:
        return as_value(self.theta).steady and as_value(self.phi).steady

    def __call__(self, pts: Points) -> Floats:
        t, p = (np.radians(as_value(x)(pts.t, pts.X, pts.e)) for x in (self.theta, self.phi))
        t, p = np.broadcast_arrays(t, p)
        st, ct, sp, cp = np.sin(t), np.cos(t), np.sin(p), np.cos(p)
        a = np.stack((ct * sp, st * sp, cp), axis=-1)
        b = np.stack((-st, ct, 0.0 * t), axis=-1)
        return np.stack((a, b, np.stack((-ct * cp, -st * cp, sp), axis=-1)), axis=-1)


@record
class FixedVector(Steady):
    """One direction (1, 3), or one for each element of the block (n_elements, 3)."""

    a: Floats

    def __call__(self, pts: Points) -> Floats:
        return self.a if len(self.a) == 1 else self.a[pts.e]


def fixed_vector(v: ArrayLike) -> FixedVector:
    """``fiber type="vector"``, and per-element data (``user``, ``map``) where ``v`` is (n_elements, 3)."""
    return FixedVector(np.atleast_2d(np.asarray(v, dtype=float)))


def local_vector(X: Floats, nodes: tuple[int, int] = (0, 0)) -> FixedVector:
    """``fiber type="local"``: from one element node to another; ``X`` (n_elements, n_nodes, 3), 1-based."""
    n1, n2 = nodes if any(k > 0 for k in nodes) else (1, 2)
    return FixedVector(unit(X[:, n2 - 1] - X[:, n1 - 1]))


@record
class SphericalVector(Steady):
    """``fiber type="spherical"``: ``vector`` turned with the radius from ``center``."""

    center: ArrayLike = (0.0, 0.0, 0.0)
    vector: ArrayLike = (1.0, 0.0, 0.0)

    def __call__(self, pts: Points) -> Floats:
        return turn(unit(self.vector), _X, unit(pts.X - np.asarray(self.center)))


@record
class CylindricalVector(Steady):
    """``fiber type="cylindrical"``: ``vector`` turned with the radius from the ``axis`` through ``center``."""

    center: ArrayLike = (0.0, 0.0, 0.0)
    axis: ArrayLike = (0.0, 0.0, 1.0)
    vector: ArrayLike = (1.0, 0.0, 0.0)

    def __call__(self, pts: Points) -> Floats:
        b, _ = _radius(pts.X, self.center, self.axis)
        return turn(unit(self.vector), turn(_X, _Z, unit(self.axis)), b)


@record
class AngleVector:
    """``fiber type="angles"``: spherical angles in degrees, ``phi`` from z."""

    theta: Number = 0.0
    phi: Number = 90.0

    @property
    def steady(self) -> bool:
        return as_value(self.theta).steady and as_value(self.phi).steady

    def __call__(self, pts: Points) -> Floats:
        return AngleAxes(self.theta, self.phi)(pts)[..., 0]


@record
class MathVector:
    """``fiber type="math"``: three values, one a component."""

    x: Number
    y: Number
    z: Number

    @property
    def steady(self) -> bool:
        return all(as_value(v).steady for v in (self.x, self.y, self.z))

    def __call__(self, pts: Points) -> Floats:
        parts = (as_value(v)(pts.t, pts.X, pts.e) for v in (self.x, self.y, self.z))
        return np.stack(np.broadcast_arrays(*parts), axis=-1)
