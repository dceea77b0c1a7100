"""Finite rotations as unit quaternions (x, y, z, w).

Increments of rotation are Cayley vectors, 2 tan(angle / 2) along the axis, as in FEBio (theory manual, "Rigid
bodies"); prescribed rotations are rotation vectors, the angle along the axis.
"""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
IDENTITY = (0.0, 0.0, 0.0, 1.0)


def product(p: Floats, q: Floats) -> Floats:
    """p q: the rotation q, then p."""
    a, b, c, w = p
    x, y, z, v = q
    return np.array([
        w * x + a * v + b * z - c * y, w * y + b * v + c * x - a * z,
        w * z + c * v + a * y - b * x, w * v - a * x - b * y - c * z,
    ])  # fmt: skip


def conjugate(q: Floats) -> Floats:
    return np.array([-q[0], -q[1], -q[2], q[3]])


def unit(q: Floats) -> Floats:
    return np.asarray(q / sqrt(float(q @ q)))


def of_vector(v: Floats) -> Floats:
    """Rotation by |v| about v."""
    angle = sqrt(float(v @ v))
    s = sin(0.5 * angle) / angle if angle > 0 else 0.5
    return np.array([s * v[0], s * v[1], s * v[2], cos(0.5 * angle)])


def of_cayley(v: Floats) -> Floats:
    """Rotation of the Cayley vector v: (v / 2, 1), made a unit."""
    return unit(np.array([0.5 * v[0], 0.5 * v[1], 0.5 * v[2], 1.0]))


def of_euler(x: float, y: float, z: float) -> Floats:
    """Rotation about x, then y, then z, angles in radians."""
    cx, cy, cz, sx, sy, sz = (f(0.5 * a) for f in (cos, sin) for a in (x, y, z))
    return np.array([
        cz * sx * cy - sz * cx * sy, cz * cx * sy + sz * sx * cy,
        sz * cx * cy - cz * sx * sy, cz * cx * cy + sz * sx * sy,
    ])  # fmt: skip


def cayley(q: Floats) -> Floats:
    """The Cayley vector of a rotation of less than half a turn."""
    return np.asarray(2.0 * q[:3] / q[3])


def vector(q: Floats) -> Floats:
    """The rotation vector, its angle from 0 to 2 pi."""
    s = sqrt(float(q[:3] @ q[:3]))
    return np.asarray(q[:3] * (2.0 * atan2(s, q[3]) / s)) if s > 0 else np.zeros(3)


def matrix(q: Floats) -> Floats:
    x, y, z, w = q
    return np.array([
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ])  # fmt: skip


def skew(v: Floats) -> Floats:
    """[v] with [v] a = v x a."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
