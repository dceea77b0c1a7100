"""Rigid bodies by central differences, as FEBio's explicit solver moves them.

Velocities and accelerations of a body are those of its centre, and of its rotation about its own axes (W, P):
a' = F / m, P = I^-1 (M - W x I W) with M about its own axes. FEBio adds P over half a step only, where a velocity takes
the accelerations of both its ends, and turns the centre's velocity and acceleration with the body; so does this.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import rotation

if TYPE_CHECKING:
    from ..state import State
    from ..system import System
    from .bodies import Bodies

Floats = NDArray[np.float64]


class Central:
    """``shifts``, ``turns`` (body, 3): equations of centres and rotations, -1 where there is none."""

    def __init__(self, bodies: Bodies, system: System) -> None:
        self.bodies, self.state = bodies, system.state
        eq = system.eqs.eq[:, bodies.span]
        self.shifts, self.turns = eq[bodies.rows], eq[bodies.rows + 1]
        self.inverse = [np.linalg.inv(I) if np.linalg.det(I) > 0.0 else np.zeros((3, 3)) for I in bodies.inertia]

    def _axes(self, i: int) -> Floats:
        return rotation.matrix(self.state.extra["q"][i])

    def place(self, u: Floats) -> None:
        """Angles about a body's own axes in ``u`` become Cayley vectors in space, as :meth:`Bodies.move` takes them."""
        for i, e in enumerate(self.turns):
            some = e >= 0
            if some.any():
                angle = self._axes(i) @ np.where(some, u[e], 0.0)
                u[e[some]] = rotation.cayley(rotation.of_vector(angle))[some]

    def start(self, R: Floats, v: Floats, a: Floats) -> None:
        """Velocities given, and accelerations of the centres under the residual R; rotations begin with none."""
        s, rows = self.state, self.bodies.rows
        for i, (shift, turn) in enumerate(zip(self.shifts, self.turns, strict=True)):
            some, free = shift >= 0, turn >= 0
            v[shift[some]] = s.velocity_old[rows[i]][some]
            v[turn[free]] = (self._axes(i).T @ s.velocity_old[rows[i] + 1])[free]
            if some.any():
                a[shift[some]] = R[shift[some]] / self.bodies.mass[i]

    def finish(self, R: Floats, v: Floats, a: Floats, damping: float, dt: float) -> None:
        """Velocities and accelerations after a step, under the residual R at its end."""
        for i, (shift, turn) in enumerate(zip(self.shifts, self.turns, strict=True)):
            Q = self._axes(i)
            held, fixed = shift < 0, turn < 0
            force, moment = np.where(held, 0.0, R[shift]), np.where(fixed, 0.0, R[turn])
            speed, spin = np.where(held, 0.0, v[shift]), np.where(fixed, 0.0, damping * v[turn])
            if not held.all():
                pull = force / self.bodies.mass[i]
                v[shift[~held]] = (Q @ np.where(held, 0.0, damping * (speed + 0.5 * dt * pull)))[~held]
                a[shift[~held]] = (Q @ pull)[~held]
            if not fixed.all():
                I = self.bodies.inertia[i]
                v[turn[~fixed]] = spin[~fixed]
                a[turn[~fixed]] = (self.inverse[i] @ (Q.T @ moment - np.cross(spin, I @ spin)))[~fixed]

    def rates(self, s: State) -> None:
        """Angular velocities and accelerations in space, of those about the bodies' axes."""
        for i, r in enumerate(self.bodies.rows + 1):
            Q = self._axes(i)
            s.velocity[r], s.acceleration[r] = Q @ s.velocity[r], Q @ s.acceleration[r]
