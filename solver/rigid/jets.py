"""Values with their derivatives by twelve unknowns: two bodies' displacements and rotations, a's and then b's.

A force law written in jets has its tangent with it. A small rotation ``dphi`` is applied after the present one:
dQ = [dphi] Q.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import rotation

if TYPE_CHECKING:
    from ..system import System

Floats = NDArray[np.float64]
UNKNOWNS = 12


@dataclass(slots=True, eq=False)
class Jet:
    """A scalar or vector ``v`` (...) and its derivatives ``d`` (..., 12)."""

    v: Floats | float
    d: Floats

    def __add__(self, o: Jet) -> Jet:
        return Jet(self.v + o.v, self.d + o.d)

    def __sub__(self, o: Jet) -> Jet:
        return Jet(self.v - o.v, self.d - o.d)

    def __neg__(self) -> Jet:
        return Jet(-self.v, -self.d)

    def times(self, c: float) -> Jet:
        """By a number."""
        return Jet(self.v * c, self.d * c)

    def scaled(self, c: Jet) -> Jet:
        """A vector by a scalar."""
        return Jet(self.v * c.v, self.d * c.v + np.outer(self.v, c.d))


def zero() -> Jet:
    return constant(np.zeros(3))


def constant(v: Floats) -> Jet:
    return Jet(v, np.zeros((len(v), UNKNOWNS)))


def cross(a: Jet, b: Jet) -> Jet:
    A, B = rotation.skew(np.asarray(a.v)), rotation.skew(np.asarray(b.v))
    return Jet(A @ b.v, np.asarray(A @ b.d) - B @ a.d)


def dot(a: Jet, b: Jet) -> Jet:
    return Jet(float(a.v @ b.v), a.v @ b.d + b.v @ a.d)  # type: ignore[operator]


def norm(a: Jet) -> Jet:
    """|a|, with no derivative where it is zero."""
    n = sqrt(float(a.v @ a.v))  # type: ignore[operator]
    return Jet(n, (a.v @ a.d) / n if n > 0 else np.zeros(UNKNOWNS))  # type: ignore[operator]


def direction(a: Jet) -> Jet:
    """a / |a|; zero where a is."""
    n = norm(a)
    if n.v == 0.0:
        return Jet(a.v, 0.0 * a.d)
    u = a.v / n.v
    return Jet(u, (a.d - np.outer(u, n.d)) / n.v)


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
    L, R = _left(p.v), _right(q.v)  # type: ignore[arg-type]
    return Jet(L @ q.v, L @ q.d + R @ p.d)


def conjugate(q: Jet) -> Jet:
    sign = np.array([-1.0, -1.0, -1.0, 1.0])
    return Jet(q.v * sign, q.d * sign[:, None])


def rotation_vector(q: Jet) -> Jet:
    """Of a quaternion of any length, the angle from 0 to 2 pi."""
    v, w, dv, dw = q.v[:3], q.v[3], q.d[:3], q.d[3]  # type: ignore[index]
    s = sqrt(float(v @ v))
    if s < 1e-150:
        return Jet(2.0 * v / w, 2.0 * dv / w)
    n, angle = v / s, 2.0 * atan2(s, w)
    ds = n @ dv
    turn = 2.0 * (w * ds - s * dw) / (s * s + w * w)
    return Jet(n * angle, (dv - np.outer(n, ds)) * (angle / s) + np.outer(n, turn))


class Frame:
    """A body at a time between the last step and the present (alpha); ``slot`` 0 for body a, 6 for body b."""

    def __init__(self, system: System, body: int, slot: int) -> None:
        s, bodies = system.state, system.bodies
        assert bodies is not None
        self.s, self.system, self.slot, self.alpha = s, system, slot, system.alphaf
        self.body, self.row = bodies.bodies[body], int(bodies.rows[body])
        self.q, self.q_old = s.extra["q"][body], s.extra["q_old"][body]
        self.Q, self.Q_old = rotation.matrix(self.q), rotation.matrix(self.q_old)

    def _jet(self, now: Floats, old: Floats, shift: Floats | None, turn: Floats | None) -> Jet:
        a, k = self.alpha, self.slot
        d = np.zeros((len(now), UNKNOWNS))
        if shift is not None:
            d[:, k : k + 3] = a * shift
        if turn is not None:
            d[:, k + 3 : k + 6] = a * turn
        return Jet(now if a == 1.0 else a * now + (1 - a) * old, d)

    def centre(self) -> Jet:
        c, s = self.body.centre, self.s
        return self._jet(c + s.u[self.row], c + s.u_old[self.row], np.eye(3), None)

    def vector(self, Z: Floats) -> Jet:
        """A vector Z of the reference, turned with the body."""
        z = self.Q @ Z
        return self._jet(z, self.Q_old @ Z, None, -rotation.skew(z))

    def arm(self, X: Floats) -> Jet:
        """From the centre to the body's point that was at X."""
        return self.vector(X - self.body.centre)

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
        z, z_old, w, w_old = self.Q @ Z, self.Q_old @ Z, s.velocity[r + 1], s.velocity_old[r + 1]
        shift, turn = self._rates()
        now, old = s.velocity[r] + np.cross(w, z), s.velocity_old[r] + np.cross(w_old, z_old)
        return self._jet(now, old, shift, -rotation.skew(z) @ turn - rotation.skew(w) @ rotation.skew(z))
