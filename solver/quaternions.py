"""Finite rotations of many points at once, as unit quaternions (..., 4): x y z w.

Single rotations: :mod:`.rigid.rotation`.
Rotation vectors (..., 3) are the angle, from 0 to 2 pi, along the axis.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def identity(*shape: int) -> Floats:
    """No rotation (*shape, 4)."""
    return np.tile([0.0, 0.0, 0.0, 1.0], (*shape, 1))


def product(p: Floats, q: Floats) -> Floats:
    """p q: the rotation q, then p."""
    a, b, v, w = p[..., :3], q[..., :3], p[..., 3:], q[..., 3:]
    return np.concatenate([v * b + w * a + cross(a, b), v * w - (a * b).sum(axis=-1, keepdims=True)], axis=-1)


def conjugate(q: Floats) -> Floats:
    """The inverse rotation."""
    return q * [-1.0, -1.0, -1.0, 1.0]


def of_vector(v: Floats) -> Floats:
    """Rotation by |v| about v."""
    half = 0.5 * np.sqrt((v * v).sum(axis=-1, keepdims=True))
    return np.concatenate([0.5 * v * np.sinc(half / np.pi), np.cos(half)], axis=-1)


def vector(q: Floats) -> Floats:
    """The rotation vector."""
    s = np.sqrt((q[..., :3] ** 2).sum(axis=-1, keepdims=True))
    angle = 2.0 * np.arctan2(s, q[..., 3:])
    return np.asarray(q[..., :3] * np.where(s > 0.0, angle / np.where(s > 0.0, s, 1.0), 0.0))


def matrix(q: Floats) -> Floats:
    """Rotation matrices (..., 3, 3)."""
    S = skew(q[..., :3])
    return np.eye(3) + 2.0 * (q[..., 3, None, None] * S + S @ S)


def rotate(q: Floats, v: Floats) -> Floats:
    """v turned by q."""
    t = 2.0 * cross(q[..., :3], v)
    return np.asarray(v + q[..., 3:] * t + cross(q[..., :3], t))


def cross(a: Floats, b: Floats) -> Floats:
    """a x b; np.cross takes ten times as long for few vectors."""
    x, y, z, u, v, w = a[..., 0], a[..., 1], a[..., 2], b[..., 0], b[..., 1], b[..., 2]
    first = y * w - z * v
    out = np.empty((*first.shape, 3))
    out[..., 0] = first
    out[..., 1] = z * u - x * w
    out[..., 2] = x * v - y * u
    return out


def skew(v: Floats) -> Floats:
    """[v] (..., 3, 3) with [v] a = v x a."""
    out = np.zeros((*v.shape, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[..., k, j], out[..., j, k] = v[..., i], -v[..., i]
    return out


def of_increment(v: Floats) -> Floats:
    """X (..., 3, 3): where the rotation of v is turned further by a small d, its vector grows by X d, turned too.

    X = 1 + [v] / 2 + (1 / a^2 - (1 + cos a) / (2 a sin a)) [v]^2, a = |v|.
    """
    S, a2 = skew(v), (v * v).sum(axis=-1)[..., None, None]
    a = np.sqrt(np.where(a2 > 1e-8, a2, 1.0))
    c = np.where(a2 > 1e-8, 1.0 / a**2 - 0.5 / (a * np.tan(0.5 * a)), 1.0 / 12.0 + a2 / 720.0)
    return np.eye(3) + 0.5 * S + c * (S @ S)
