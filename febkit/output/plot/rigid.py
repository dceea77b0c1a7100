"""Rigid bodies: one value for each of their parts."""

from __future__ import annotations

from collections.abc import Callable
from math import asin, atan2
from typing import Any

import numpy as np

from febkit.solver.loads.rigid import RigidFollowerForce, RigidFollowerMoment
from febkit.solver.rigid import rotation
from febkit.solver.rigid.connectors import Connectors

from .base import Floats, Part, View, register, shared
from .nodes import unbalanced


class Body:
    """A rigid body in a state: ``row`` is the first of its rows in nodal arrays, the second is of rotations."""

    def __init__(self, view: View, index: int) -> None:
        bodies = view.run.bodies
        assert bodies is not None
        self.view, self.index, self.bodies = view, index, bodies
        self.record = bodies.bodies[index]
        self.row = int(bodies.rows[index])

    @property
    def position(self) -> Floats:
        """Of the centre of mass (3,)."""
        return self.record.centre + self.view.state.u[self.row]

    @property
    def old_position(self) -> Floats:
        return self.record.centre + self.view.state.u_old[self.row]

    @property
    def quaternion(self) -> Floats:
        return self.view.state.extra["q"][self.index]

    @property
    def old_quaternion(self) -> Floats:
        return self.view.state.extra["q_old"][self.index]

    @property
    def turn(self) -> Floats:
        """Rotation (3, 3)."""
        return rotation.matrix(self.quaternion)

    @property
    def rotation(self) -> Floats:
        """Rotation vector (3,)."""
        return rotation.vector(self.quaternion)

    @property
    def velocity(self) -> Floats:
        return self.view.state.velocity[self.row]

    @property
    def old_velocity(self) -> Floats:
        return self.view.state.velocity_old[self.row]

    @property
    def acceleration(self) -> Floats:
        return self.view.state.acceleration[self.row]

    @property
    def spin(self) -> Floats:
        """Angular velocity (3,)."""
        return self.view.state.velocity[self.row + 1]

    @property
    def old_spin(self) -> Floats:
        return self.view.state.velocity_old[self.row + 1]

    @property
    def angular_acceleration(self) -> Floats:
        return self.view.state.acceleration[self.row + 1]

    @property
    def momentum(self) -> Floats:
        return self.record.mass * self.velocity

    @property
    def angular_momentum(self) -> Floats:
        """J w about the centre, J in the present orientation."""
        return self.turn @ self.record.inertia @ self.turn.T @ self.spin

    @property
    def kinetic_energy(self) -> Floats:
        return np.array(0.5 * (self.momentum @ self.velocity + self.angular_momentum @ self.spin))

    @property
    def force(self) -> Floats:
        return reactions(self.view)[self.index, :3]

    @property
    def moment(self) -> Floats:
        """About the centre."""
        return reactions(self.view)[self.index, 3:]


@shared
def reactions(view: View) -> Floats:
    """Forces and moments (body, 6) on what bodies hold: minus all that acts on the nodes they carry and by connectors.

    Forces and moments that a rigid load gives directly are no part of it, as in FEBio; those of followers are.
    """
    s, system, bodies = view.state, view.run.system, view.run.bodies
    out = np.zeros((len(bodies.bodies) if bodies is not None else 0, 6))
    if system is None or bodies is None:
        return out
    R, f = np.zeros_like(s.d), unbalanced(view)
    x = s.X + system.alphaf * s.u + (1 - system.alphaf) * s.u_old
    for i, row in enumerate(bodies.rows):
        carried = np.flatnonzero(bodies.owner == row)
        out[i, :3] -= f[carried].sum(axis=0)
        out[i, 3:] -= np.cross(x[carried] - x[row], f[carried]).sum(axis=0)
    for load in system.loads:
        follows = isinstance(load, (RigidFollowerForce, RigidFollowerMoment))
        if follows or isinstance(load, Connectors):
            R[...] = 0.0
            load.residual(s, R)
            both = np.hstack([s.layout.u(R)[bodies.rows], s.layout.u(R)[bodies.rows + 1]])
            out += both if follows else -both
    return out


def euler(body: Body) -> Floats:
    """Angles about x, then y, then z (3,), in radians."""
    m = body.turn
    if abs(abs(m[2, 0]) - 1.0) < 1e-12:
        up = -np.sign(m[2, 0])
        return np.array([atan2(up * m[0, 1], up * m[0, 2]), up * 0.5 * np.pi, 0.0])
    y = -asin(m[2, 0])
    return np.array([atan2(m[2, 1], m[2, 2]), y, atan2(m[1, 0], m[0, 0])])


def every(view: View) -> list[Body]:
    """The bodies of a run in their order."""
    found = view.run.bodies
    return [] if found is None else [Body(view, i) for i in range(len(found.bodies))]


def bodies(view: View) -> dict[str, Body]:
    """The body of each rigid part, by the part's name."""
    return {p.block.name: b for b in every(view) for p in b.record.parts}


def of_body(value: Callable[[Body], Floats]) -> Callable[[Part], Floats | None]:
    """A value of the body that a part belongs to."""

    def give(part: Part) -> Floats | None:
        body: Any = bodies(part.view).get(part.name)
        return None if body is None else value(body)

    return give


register("rigid position", of_body(lambda b: b.position))
register("rigid velocity", of_body(lambda b: b.velocity))
register("rigid acceleration", of_body(lambda b: b.acceleration))
register("rigid angular position", of_body(lambda b: b.rotation))
register("rigid rotation vector", of_body(lambda b: b.rotation))
register("rigid angular velocity", of_body(lambda b: b.spin))
register("rigid angular acceleration", of_body(lambda b: b.angular_acceleration))
register("rigid linear momentum", of_body(lambda b: b.momentum))
register("rigid angular momentum", of_body(lambda b: b.angular_momentum))
register("rigid kinetic energy", of_body(lambda b: b.kinetic_energy))
register("Euler angle", of_body(euler))
register("rigid force", of_body(lambda b: b.force))
register("rigid torque", of_body(lambda b: b.moment))
