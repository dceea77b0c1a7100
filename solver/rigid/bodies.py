"""Rigid bodies at work: how they move, what they carry, their inertia.

A. Motion: x = r + Q (X - r0), Q the body's rotation; increments of rotation are composed, not added. Forces on
carried nodes act on the body as their sum and the sum of z x f, z = x - r. Angular velocity and acceleration follow
the Newmark rule in Cayley vectors. FEBio theory manual, "Rigid bodies" and "Dynamics of rigid bodies".
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..fields import DISPLACEMENT
from ..pattern import GIVEN
from . import rotation
from .body import RigidBody

if TYPE_CHECKING:
    from ..fields import Layout
    from ..pattern import Equations
    from ..problem import Attached, Problem
    from ..state import State
    from ..system import System
    from .connectors import Connectors

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def row(body: int, nodes: int) -> int:
    """First of the two rows of a body where there are so many nodes."""
    return nodes + 2 * body


class Bodies:
    """All rigid bodies of a problem; ``rows`` (body,) are their first rows."""

    def __init__(self, problem: Problem, state: State) -> None:
        self.bodies: list[RigidBody] = problem.bodies
        n, k = len(problem.X), len(self.bodies)
        self.rows = n + 2 * np.arange(k)
        # of displacements in the first row of a body, rotations in the second
        self.columns, self.span = state.layout.displacement, state.layout[DISPLACEMENT.name]
        self.parts = [p for b in self.bodies for p in b.parts]
        self.mass = np.array([b.mass for b in self.bodies])
        self.inertia = np.array([b.inertia for b in self.bodies])
        self._own = [(i, b.nodes) for i, b in enumerate(self.bodies)]
        state.extra["q"] = np.tile(rotation.IDENTITY, (k, 1))
        # angular momentum and its rate
        state.extra["h"], state.extra["dh"] = np.zeros((k, 3)), np.zeros((k, 3))
        self.start(state)
        for name in ("q", "h", "dh"):
            state.extra[f"{name}_old"] = state.extra[name].copy()
        steps = [problem.common, *problem.steps]
        records = [c for step in steps for c in step.connectors]
        self.connectors: Connectors | None = None
        if records:
            from .connectors import Connectors

            self.connectors = Connectors(records, state)

    def start(self, s: State) -> None:
        """Angular momentum of the angular velocities given."""
        s.extra["h"] = np.einsum("bij,bj->bi", self._spatial(s), s.velocity[self.rows + 1])
        s.extra["h_old"] = s.extra["h"].copy()
        for rows in (self.rows, self.rows + 1):
            s.velocity_old[rows] = s.velocity[rows]

    def _spatial(self, s: State) -> Floats:
        """Inertia about the centres in the present orientation (body, 3, 3)."""
        Q = np.array([rotation.matrix(q) for q in s.extra["q"]]).reshape(-1, 3, 3)
        return np.asarray(Q @ self.inertia @ np.swapaxes(Q, 1, 2))

    # ---- what they carry --------------------------------------------------------------------------
    def attach(self, s: State, attached: list[Attached]) -> None:
        """Take the nodes of the bodies' parts and ``attached`` ones, where they are now."""
        self.owner = np.full(len(s.X), -1, np.int32)
        for i, nodes in [*self._own, *((a.body, a.nodes) for a in attached)]:
            self.owner[nodes] = self.rows[i]
        self.nodes = np.flatnonzero(self.owner >= 0)
        self._at = self.owner[self.nodes]
        self._body = (self._at - self.rows[0]) // 2
        x, z = s.x, np.zeros((len(self.nodes), 3))
        for i, b in enumerate(self.bodies):
            own = self._body == i
            z[own] = (x[self.nodes[own]] - b.centre - s.u[self.rows[i]]) @ rotation.matrix(s.extra["q"][i])
        self._arm = z

    def cliques(self) -> list[NDArray[np.int32]]:
        """The rows of each body."""
        return [np.stack([self.rows, self.rows + 1], axis=1).astype(np.int32)]

    def counted(self, eqs: Equations) -> Floats:
        """How many nodes each equation moves as a whole: 1, those carried for a displacement, 0 for a rotation."""
        out = np.ones(eqs.n)
        for i, r in enumerate(self.rows):
            for row, count in ((r, (self._body == i).sum()), (r + 1, 0)):
                e = self._equations(eqs, row)
                out[e[e >= 0]] = count
        return out

    def tied(self, layout: Layout) -> tuple[Ints, Ints, Ints]:
        """Carried nodes depend on three unknowns each: du_i = dt_i + dtheta_j z_k - dtheta_k z_j."""
        i = layout.displacement
        j, k = np.roll(i, -1), np.roll(i, -2)
        own = (self.nodes[:, None] * layout.width + i).reshape(-1)
        shift, turn = self._at[:, None] * layout.width, (self._at[:, None] + 1) * layout.width
        masters = np.stack([shift + i, turn + j, turn + k], axis=2).reshape(-1)
        return own, np.full(len(own), 3), masters

    def weights(self, s: State, alpha: float) -> Floats:
        i = np.arange(3)
        z = self._arms(s, alpha)
        return np.stack([np.ones_like(z), z[:, (i + 2) % 3], -z[:, (i + 1) % 3]], axis=2).reshape(-1)

    # ---- motion -----------------------------------------------------------------------------------
    def move(self, s: State, eqs: Equations, increment: Floats, u: Floats) -> None:
        """Rotate by the increment so far and then ``u`` (equations), or as prescribed; move the nodes along."""
        q, turned = s.extra["q"], s.u
        for i, r in enumerate(self.rows + 1):
            given = eqs.kind[r, self.span] == GIVEN
            if given.any():
                turned[r] = np.where(given, turned[r], 0.0)
                q[i] = rotation.of_vector(turned[r])
                continue
            a, b = self._turn(eqs, increment, r), self._turn(eqs, u, r)
            if a is not None and b is not None:
                turn = rotation.product(rotation.of_cayley(b), rotation.of_cayley(a))
                q[i] = rotation.unit(rotation.product(turn, s.extra["q_old"][i]))
                turned[r] = rotation.vector(q[i])
        self._carry(s)

    def _equations(self, eqs: Equations, row: np.integer) -> NDArray[np.int32]:
        """Equations of a body's row (3,), -1 where it has none."""
        return eqs.eq[row, self.span]

    def _turn(self, eqs: Equations, vector: Floats, row: np.integer) -> Floats | None:
        """Entries of an equation vector at a row of rotations; None where all are held."""
        e = self._equations(eqs, row)
        return np.where(e >= 0, vector[e], 0.0) if (e >= 0).any() else None

    def _carry(self, s: State) -> None:
        Q = np.array([rotation.matrix(q) for q in s.extra["q"]])
        u = s.u
        centre = s.X[self._at] + u[self._at]
        u[self.nodes] = centre + np.einsum("nij,nj->ni", Q[self._body], self._arm) - s.X[self.nodes]

    def compose(self, eqs: Equations, total: Floats, a: Floats, b: Floats) -> Floats:
        """``total`` = a + b with the rotations composed, b after a."""
        for r in self.rows + 1:
            p, q = self._turn(eqs, a, r), self._turn(eqs, b, r)
            if p is not None and q is not None:
                e = self._equations(eqs, r)
                both = rotation.product(rotation.of_cayley(q), rotation.of_cayley(p))
                total[e[e >= 0]] = rotation.cayley(both)[e >= 0]
        return total

    # ---- rates ------------------------------------------------------------------------------------
    def begin_step(self, s: State, system: System) -> None:
        """The present state becomes the last converged one; rates are predicted for no further motion."""
        for name in ("q", "h", "dh"):
            s.extra[f"{name}_old"] = s.extra[name].copy()
        self.rates(s, system)

    def rates(self, s: State, system: System) -> None:
        """Velocities and accelerations at the present position by the Newmark rule."""
        dt, beta, gamma = s.dt, system.beta, system.gamma
        if dt <= 0:
            return
        t, r, a, c = self.rows, self.rows + 1, 1.0 / (beta * dt), 1.0 - 0.5 / beta
        v, w, at, al = s.velocity_old[t], s.velocity_old[r], s.acceleration_old[t], s.acceleration_old[r]
        s.acceleration[t] = (s.u[t] - s.u_old[t]) * (a / dt) - v * a + at * c
        s.velocity[t] = v + dt * ((1 - gamma) * at + gamma * s.acceleration[t])
        for i in range(len(r)):
            turn = self._turned(s, i)
            Q, theta = rotation.matrix(turn), rotation.cayley(turn)
            s.velocity[r[i]] = Q @ (theta * (a * gamma) - w[i] + (w[i] + 0.5 * dt * al[i]) * (2 - gamma / beta))
            s.acceleration[r[i]] = Q @ (theta * (a / dt) - w[i] * a + al[i] * c)

    @staticmethod
    def _turned(s: State, i: int) -> Floats:
        """Rotation of body i since the last converged state."""
        return rotation.unit(rotation.product(s.extra["q"][i], rotation.conjugate(s.extra["q_old"][i])))

    # ---- forces -----------------------------------------------------------------------------------
    def _arms(self, s: State, alpha: float) -> Floats:
        """x - r of carried nodes at a time between the last step (alpha 0) and the present (alpha 1)."""
        d = s.u if alpha == 1.0 else alpha * s.u + (1 - alpha) * s.u_old
        z: Floats = s.X[self.nodes] + d[self.nodes] - s.X[self._at] - d[self._at]
        return z

    def inertia_forces(self, s: State, R: Floats, alpham: float) -> None:
        """R -= m a and the rate of angular momentum w x J w + J w'."""
        a = alpham * s.acceleration[self.rows] + (1 - alpham) * s.acceleration_old[self.rows]
        Ru = s.layout.u(R)
        Ru[self.rows] -= self.mass[:, None] * a
        J, w, al = self._spatial(s), s.velocity[self.rows + 1], s.acceleration[self.rows + 1]
        h = s.extra["h"] = np.einsum("bij,bj->bi", J, w)
        dh = s.extra["dh"] = np.cross(w, h) + np.einsum("bij,bj->bi", J, al)
        Ru[self.rows + 1] -= alpham * dh + (1 - alpham) * s.extra["dh_old"]

    # ---- tangent ----------------------------------------------------------------------------------
    def inertia_tangent(self, s: State, system: System) -> list[tuple[Floats, Ints, Ints]]:
        """Minus the derivative of the inertia forces, as triples (K, nodes, columns); of t = 0, see below."""
        dt, beta, gamma, alpham = s.dt, system.beta, system.gamma, system.alpham
        a = alpham / (beta * dt * dt)
        if s.time == 0.0:  # FEBio's mass matrix for the accelerations at the start; its rotations keep their scale
            a = alpham = 1.0
        K, J, I = np.zeros((len(self.rows), 6, 6)), self._spatial(s), np.eye(3)
        for i, r in enumerate(self.rows + 1):
            K[i, :3, :3] = self.mass[i] * a * I
            theta = rotation.cayley(self._turned(s, i))
            T = I + 0.5 * rotation.skew(theta) + 0.25 * np.outer(theta, theta)
            w, h, dh = s.velocity[r], s.extra["h"][i], s.extra["dh"][i]
            rate = (gamma * rotation.skew(w) + I / dt) @ J[i] - gamma * rotation.skew(h)
            K[i, 3:, 3:] = alpham * (rate @ T / (beta * dt) - rotation.skew(dh))
        nodes = np.stack([self.rows] * 3 + [self.rows + 1] * 3, axis=1)
        return [(K, nodes, np.tile(self.columns, 2))]
