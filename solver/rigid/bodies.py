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
from ..kernels import rigid as kernels
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
        self._of: Equations | None = None  # whose rotations are known
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
        out = np.empty((len(self.nodes), 3, 3))
        kernels.weights(self.nodes, self._at, alpha, s.X, s.u, s.u_old, out)
        return out.reshape(-1)

    # ---- motion -----------------------------------------------------------------------------------
    def move(self, s: State, eqs: Equations, increment: Floats, u: Floats) -> None:
        """Rotate by the increment so far and then ``u`` (equations), or as prescribed; move the nodes along."""
        q, turned = s.extra["q"], s.u
        eq, given = self._turns(eqs)
        kernels.move(self.rows, eq, given, increment, u, s.extra["q_old"], q, turned)
        kernels.carry(self.nodes, self._at, self._body, self._arm, q, s.X, turned)

    def _equations(self, eqs: Equations, row: np.integer) -> NDArray[np.int32]:
        """Equations of a body's row (3,), -1 where it has none."""
        return eqs.eq[row, self.span]

    def _turns(self, eqs: Equations) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
        """Equations of the bodies' rotations (body, 3), -1 where there is none, and which of these are prescribed."""
        if self._of is not eqs:
            r, self._of = self.rows + 1, eqs
            self._eq = np.ascontiguousarray(eqs.eq[r][:, self.span])
            self._given = np.ascontiguousarray(eqs.kind[r][:, self.span] == GIVEN)
        return self._eq, self._given

    def compose(self, eqs: Equations, total: Floats, a: Floats, b: Floats) -> Floats:
        """``total`` = a + b with the rotations composed, b after a."""
        kernels.compose(self._turns(eqs)[0], a, b, total)
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
        old = s.velocity_old, s.acceleration_old
        q, q_old, u, u_old = s.extra["q"], s.extra["q_old"], s.u, s.u_old
        kernels.rates(
            self.rows, dt, beta, gamma, q, q_old, u, u_old, s.velocity, old[0], s.acceleration, old[1]
        )

    # ---- forces -----------------------------------------------------------------------------------
    def inertia_forces(self, s: State, R: Floats, alpham: float) -> None:
        """R -= m a and the rate of angular momentum w x J w + J w'."""
        e = s.extra
        kernels.inertia(
            self.rows, alpham, self.mass, self.inertia, e["q"], s.velocity, s.acceleration, s.acceleration_old,
            e["dh_old"], e["h"], e["dh"], s.layout.u(R),
        )  # fmt: skip

    # ---- tangent ----------------------------------------------------------------------------------
    def inertia_tangent(self, s: State, system: System) -> list[tuple[Floats, Ints, Ints]]:
        """Minus the derivative of the inertia forces, as triples (K, nodes, columns); of t = 0, see below."""
        dt, beta, gamma, alpham = s.dt, system.beta, system.gamma, system.alpham
        a = alpham / (beta * dt * dt)
        if s.time == 0.0:  # FEBio's mass matrix for the accelerations at the start; its rotations keep their scale
            a = alpham = 1.0
        K, e = np.empty((len(self.rows), 6, 6)), s.extra
        kernels.inertia_tangent(
            self.rows, dt, beta, gamma, alpham, a, self.mass, self.inertia, e["q"], e["q_old"], s.velocity, e["h"],
            e["dh"], K,
        )  # fmt: skip
        nodes = np.stack([self.rows] * 3 + [self.rows + 1] * 3, axis=1)
        return [(K, nodes, np.tile(self.columns, 2))]
