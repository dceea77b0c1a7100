"""Superellipsoids: ellipsoids (squareness 2) and what lies between them and boxes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from febkit.model.mesh import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Superellipsoid:
    """|x/a|^n1 + |y/b|^n2 + |z/c|^n3 <= 1 about ``centre``, x, y, z along the columns of ``rotation``.

    ``semi_axes`` (3,) in the model's unit of length, ``squareness`` (3,) the exponents, 1 or more: the body is convex.
    Source: Barr, A.H., 1981. Superquadrics and angle-preserving transformations. IEEE Comput. Graph. Appl. 1(1), 11-23.
    """

    semi_axes: Floats
    squareness: Floats
    rotation: Floats
    centre: Floats

    def surface(self, n: Floats, inner: Floats | None = None) -> Floats:
        """Points (node, 3) of the surface for unit vectors ``n`` (node, 3); with an ellipsoid S n, S = R diag(a) R^T.

        ``inner`` (node, 3): points of the unit ball along ``n`` that are mapped instead, by the same stretch at the
        ball's surface and by S alone at its middle.
        """
        swell = reach(n @ self.rotation, self.squareness)[:, None]
        if inner is None:
            at = n * swell
        else:
            at = inner * (1.0 + np.linalg.norm(inner, axis=1, keepdims=True) * (swell - 1.0))
        x: Floats = self.centre + at @ ((self.rotation * self.semi_axes) @ self.rotation.T)
        return x

    def gauge(self, x: Floats) -> Floats:
        """The factor (point,) by which the body grows until it reaches the points: below 1 inside."""
        y = (x - self.centre) @ self.rotation / self.semi_axes
        length = np.linalg.norm(y, axis=1)
        g: Floats = length / reach(y / np.where(length > 0, length, 1.0)[:, None], self.squareness)
        return g

    def half_extents(self) -> Floats:
        """Half a bounding box (3,): the smallest where all exponents are equal, else that of the largest exponent.

        The support function of the ball of exponent n is the norm of exponent n/(n - 1).
        """
        n = float(self.squareness.max())
        dual = n / (n - 1.0) if n > 1.0 else np.inf
        e: Floats = np.linalg.norm(self.rotation * self.semi_axes, ord=dual, axis=1)
        return e

    @property
    def volume(self) -> float:
        """8 abc G(1+1/n1) G(1+1/n2) G(1+1/n3) / G(1 + 1/n1 + 1/n2 + 1/n3), G the Gamma function (Dirichlet)."""
        p = 1.0 / self.squareness
        gammas = math.prod(math.gamma(1.0 + float(q)) for q in p) / math.gamma(1.0 + float(p.sum()))
        return 8.0 * float(self.semi_axes.prod()) * gammas


def reach(m: Floats, squareness: Floats) -> Floats:
    """s (node,) with |s m1|^n1 + |s m2|^n2 + |s m3|^n3 = 1 for unit vectors ``m`` (node, 3); 1 for exponents of 2.

    Newton's method from above: the left side is convex and grows with s. 1 for zero vectors.
    """
    s = np.ones(len(m))
    if (squareness == 2.0).all():
        return s
    some = np.abs(m).max(axis=1, initial=0.0) > 0
    a, n = np.abs(m[some]), squareness
    r = 1.0 / a.max(axis=1)
    for _ in range(100):
        powers = (r[:, None] * a) ** n
        step = (powers.sum(axis=1) - 1.0) / (powers * n).sum(axis=1)
        r *= 1.0 - step
        if (np.abs(step) < 1e-15).all():
            break
    s[some] = r
    return s


def directions(count: int = 600) -> Floats:
    """Unit vectors (count + 6, 3) spread evenly over the sphere (Fibonacci's spiral), the axes' first."""
    i = np.arange(count) + 0.5
    z, turn = 1.0 - 2.0 * i / count, np.pi * (1.0 + 5.0**0.5) * i
    spiral = np.stack([np.cos(turn) * np.sqrt(1 - z**2), np.sin(turn) * np.sqrt(1 - z**2), z], axis=1)
    return np.concatenate([np.eye(3), -np.eye(3), spiral])


def gap(inner: Superellipsoid, outer: Superellipsoid, away: Floats) -> tuple[float, float]:
    """Least and largest distance from the inner surface to the outer one along rays from the inner centre.

    Rays that go against the vector ``away`` are left out. Negative where the inner body sticks out. Measured in 606
    directions, to 1e-12 of the bodies' size.
    """
    n = directions()
    n = n[n @ away >= 0.0]
    from_inner = inner.surface(n) - inner.centre
    length = np.linalg.norm(from_inner, axis=1)
    ray = from_inner / length[:, None]
    if outer.gauge(inner.centre[None])[0] >= 1.0:
        return -float(length.max()), 0.0
    low, high = np.zeros(len(n)), np.full(len(n), 2.0 * float(np.linalg.norm(outer.semi_axes)) * 3.0**0.5)
    for _ in range(40):
        middle = (low + high) / 2.0
        inside = outer.gauge(inner.centre + middle[:, None] * ray) < 1.0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    thick = low - length
    return float(thick.min()), float(thick.max())
