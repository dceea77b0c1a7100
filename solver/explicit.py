"""Explicit dynamics: central differences with lumped masses, a residual a step and no tangent.

v += a dt / 2, u += v dt, a = M^-1 R(u), v = damping (v + a dt / 2). FEBio User Manual, "explicit-solid"; masses are
lumped by rows or by the diagonal (Hinton, Rock and Zienkiewicz, Earthq Eng Struct Dyn 4 (1976) 245).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .mass import elements
from .newton import Counts, Newton, Strategy
from .system import System

if TYPE_CHECKING:
    from .rigid import central

Floats = NDArray[np.float64]


@dataclass(eq=False)
class Central:
    """``by_rows``: masses are sums of rows, else in proportion to the diagonal; ``damping``: factor of velocities."""

    by_rows: bool = False
    damping: float = 1.0


def lumped(system: System, by_rows: bool) -> Floats:
    """Masses of the nodes (node,). Those by the diagonal weigh each point by its weight once more, as in FEBio."""
    out = np.zeros(len(system.state.d))
    for g in system.groups:
        M = elements(g)
        if by_rows:
            m = M.sum(axis=2)
        else:
            diagonal = np.einsum("eaa->ea", M)
            rho = np.broadcast_to(g.block.solid.density(g.points()), (g.m * g.g,)).reshape(g.m, g.g)
            whole = (rho * g.wJ0 * g.element.weights).sum(axis=1)
            m = diagonal * (whole / diagonal.sum(axis=1))[:, None]
        np.add.at(out, g.conn, m)
    return out


class Explicit(Newton):
    """Time steps of one system; nodal velocities start from rest, as in FEBio."""

    def __init__(self, system: System, how: Central, *args: Any) -> None:
        super().__init__(system, *args)
        self.how = how
        system.dynamic = False  # neither Newmark's rates nor inertia in the residual
        mass = np.repeat(lumped(system, how.by_rows)[:, None], system.state.d.shape[1], axis=1)
        self.mass = system.gather(mass)
        self.v = np.zeros_like(self.total)
        self.a: Floats | None = None
        self.bodies: central.Central | None = None
        if system.bodies is not None:
            from .rigid import central

            self.bodies = central.Central(system.bodies, system)

    def step(self, how: Strategy | None = None) -> Counts:
        """Take the present time step."""
        s, system = self.system.state, self.system
        self.count = Counts(iterations=1)
        if self.a is None:
            self.a = self._start()
        self.v = self.v + 0.5 * s.dt * self.a
        self.increment, self.target = np.zeros_like(self.total), self._targets()
        u = s.dt * self.v
        if self.bodies is not None:
            self.bodies.place(u)
        self.move(u)
        R = self.residual()
        self.a = self._accelerations(R)
        self.v = self.how.damping * (self.v + 0.5 * s.dt * self.a)
        if self.bodies is not None:
            self.bodies.finish(R, self.v, self.a, self.how.damping, s.dt)
        self.total = self.total + u
        for values, into in ((self.v, s.velocity), (self.a, s.acceleration)):
            whole = np.zeros_like(s.d)
            system.spread(values, whole)
            into[:] = s.layout.u(whole)
        if self.bodies is not None:
            self.bodies.rates(s)
        return self.count

    def _accelerations(self, R: Floats) -> Floats:
        return np.asarray(np.where(self.mass > 0.0, R / np.where(self.mass > 0.0, self.mass, 1.0), 0.0))

    def _start(self) -> Floats:
        """Accelerations where the step starts from."""
        s = self.system.state
        now = s.time
        s.time = now - s.dt
        self.system.update()
        R = self.residual()
        out = self._accelerations(R)
        if self.bodies is not None:
            self.bodies.start(R, self.v, out)
        s.time = now
        return out

    def snapshot(self) -> Any:
        return self.total.copy(), self.v.copy(), self.a

    def restore(self, saved: Any) -> None:
        self.total, self.v, self.a = saved[0].copy(), saved[1].copy(), saved[2]
