"""Values with their derivatives by twelve unknowns: two bodies' displacements and rotations, a's and then b's.

A force law written in jets has its tangent with it. A small rotation ``dphi`` is applied after the present one:
dQ = [dphi] Q.
"""

from __future__ import annotations

from math import atan2, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..kernels import jets as kernels
from . import rotation

if TYPE_CHECKING:
    from ..system import System

Floats = NDArray[np.float64]
UNKNOWNS = 12
_ONE = np.eye(3)


class Jet:
    """A number, vector or quaternion ``v`` (k,) and its derivatives ``d`` (k, 12): rows of ``rows`` (k, 13)."""

    __slots__ = ("rows",)

    def __init__(self, rows: Floats) -> None:
        self.rows = rows

    @classmethod
    def of(cls, v: Floats, d: Floats) -> Jet:
        """Of a value (k,) and its derivatives (k, 12)."""
        return cls(np.concatenate([v[:, None], d], axis=1))

    @property
    def v(self) -> Floats:
        return self.rows[:, 0]

    @property
    def d(self) -> Floats:
        return self.rows[:, 1:]

    def __add__(self, o: Jet) -> Jet:
        return Jet(self.rows + o.rows)

    def __sub__(self, o: Jet) -> Jet:
        return Jet(self.rows - o.rows)

    def __neg__(self) -> Jet:
        return Jet(-self.rows)

    def times(self, c: float) -> Jet:
        """By a number."""
        return Jet(self.rows * c)

    def more(self, c: float) -> Jet:
        """A constant more."""
        out = self.rows.copy()
        out[:, 0] += c
        return Jet(out)

    def scaled(self, c: Jet) -> Jet:
        """A vector by a number."""
        out = np.empty_like(self.rows)
        kernels.scale(self.rows, c.rows, out)
        return Jet(out)


def zero() -> Jet:
    return Jet(np.zeros((3, 1 + UNKNOWNS)))


def constant(v: Floats) -> Jet:
    out = np.zeros((len(v), 1 + UNKNOWNS))
    out[:, 0] = v
    return Jet(out)


def cross(a: Jet, b: Jet) -> Jet:
    out = np.empty_like(a.rows)
    kernels.cross(a.rows, b.rows, out)
    return Jet(out)


def dot(a: Jet, b: Jet) -> Jet:
    out = np.empty((1, 1 + UNKNOWNS))
    kernels.dot(a.rows, b.rows, out)
    return Jet(out)


def direction(a: Jet) -> Jet:
    """a / |a|; zero where a is."""
    n = sqrt(float(a.v @ a.v))
    if n == 0.0:
        return constant(a.v)
    u = a.v / n
    return Jet.of(u, (a.d - np.outer(u, u @ a.d)) / n)


def along(e: Jet, a: Jet) -> Jet:
    """e (e . a)."""
    return e.scaled(dot(e, a))


def _left(p: Floats) -> Floats:
    """Matrix of q -> p q."""
    x, y, z, w = p
    return np.array([[w, -z, y, x], [z, w, -x, y], [-y, x, w, z], [-x, -y, -z, w]])


def _right(q: Floats) -> Floats:
    """Matrix of p -> p q."""
    x, y, z, w = q
    return np.array([[w, z, -y, x], [-z, w, x, y], [y, -x, w, z], [-x, -y, -z, w]])


def product(p: Jet, q: Jet) -> Jet:
    """Of quaternions."""
    L, R = _left(p.v), _right(q.v)
    return Jet.of(L @ q.v, L @ q.d + R @ p.d)


def conjugate(q: Jet) -> Jet:
    return Jet(q.rows * np.array([-1.0, -1.0, -1.0, 1.0])[:, None])


def rotation_vector(q: Jet) -> Jet:
    """Of a quaternion of any length, the angle from 0 to 2 pi."""
    v, w, dv, dw = q.v[:3], q.v[3], q.d[:3], q.d[3]
    s = sqrt(float(v @ v))
    if s < 1e-150:
        return Jet.of(2.0 * v / w, 2.0 * dv / w)
    n, angle = v / s, 2.0 * atan2(s, w)
    ds = n @ dv
    turn = 2.0 * (w * ds - s * dw) / (s * s + w * w)
    return Jet.of(n * angle, (dv - np.outer(n, ds)) * (angle / s) + np.outer(n, turn))


class Frame:
    """A body at a time between the last step and the present (alpha); ``slot`` 0 for body a, 6 for body b."""

    def __init__(self, system: System, body: int, slot: int) -> None:
        s, bodies = system.state, system.bodies
        assert bodies is not None
        self.s, self.system, self.slot, self.alpha = s, system, slot, system.alphaf
        self.body, self.row = bodies.bodies[body], int(bodies.rows[body])
        self.q, self.q_old = s.extra["q"][body], s.extra["q_old"][body]
        self._arms: dict[tuple[int, float], tuple[Floats, Jet]] = {}

    def _jet(self, now: Floats, old: Floats, shift: Floats | None, turn: Floats | None) -> Jet:
        a, k = self.alpha, 1 + self.slot
        out = np.zeros((len(now), 1 + UNKNOWNS))
        out[:, 0] = now if a == 1.0 else a * now + (1 - a) * old
        if shift is not None:
            out[:, k : k + 3] = a * shift
        if turn is not None:
            out[:, k + 3 : k + 6] = a * turn
        return Jet(out)

    def centre(self) -> Jet:
        c, s = self.body.centre, self.s
        return self._jet(c + s.u[self.row], c + s.u_old[self.row], _ONE, None)

    def vector(self, Z: Floats) -> Jet:
        """A vector Z of the reference, turned with the body."""
        out = np.empty((3, 1 + UNKNOWNS))
        kernels.turned(self.q, self.q_old, Z, self.alpha, self.slot + 3, out)
        return Jet(out)

    def arm(self, X: Floats) -> Jet:
        """From the centre to the body's point that was at X."""
        at = id(X), self.alpha
        if at not in self._arms:
            self._arms[at] = X, self.vector(X - self.body.centre)
        return self._arms[at][1]

    def turn(self) -> Jet:
        """The rotation, as a quaternion (not of length 1 between two times)."""
        half = 0.5 * _right(self.q)[:, :3]
        return self._jet(self.q, self.q_old, None, half)

    def _rates(self) -> tuple[Floats, Floats]:
        """Derivatives of velocity by displacement and of angular velocity by rotation (Newmark)."""
        rate = self.system.gamma / (self.system.beta * self.s.dt)
        turned = rotation.unit(rotation.product(self.q, rotation.conjugate(self.q_old)))
        theta = rotation.cayley(turned)
        T = np.eye(3) - 0.5 * rotation.skew(theta) + 0.25 * np.outer(theta, theta)
        return rate * np.eye(3), rate * rotation.matrix(turned) @ T - rotation.skew(self.s.velocity[self.row + 1])

    def spin(self) -> Jet:
        """Angular velocity."""
        s, r = self.s, self.row + 1
        return self._jet(s.velocity[r], s.velocity_old[r], None, self._rates()[1])

    def velocity(self, X: Floats) -> Jet:
        """Velocity of the body's point that was at X."""
        s, r, Z = self.s, self.row, X - self.body.centre
        z, z_old = (rotation.matrix(q) @ Z for q in (self.q, self.q_old))
        w, w_old = s.velocity[r + 1], s.velocity_old[r + 1]
        shift, turn = self._rates()
        W, arm = rotation.skew(w), rotation.skew(z)
        now, old = s.velocity[r] + W @ z, s.velocity_old[r] + rotation.skew(w_old) @ z_old
        return self._jet(now, old, shift, -arm @ turn - W @ arm)
