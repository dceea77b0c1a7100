"""Accelerations at the start of a dynamic analysis: M a = f where external forces act (FEBio's InitAccelerations)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .finite import blame, whole
from .linear.base import LinearError
from .mass import Mass

if TYPE_CHECKING:
    from .route import Route
    from .system import System

ENOUGH = 1e-8  # of the forces, that accelerations may leave over


def accelerate(system: System, route: Route) -> None:
    """Set the state's accelerations, at time 0 alone. Raises NotFinite and LinearError."""
    s = system.state
    if s.time != 0.0:
        return
    s.d_old, s.velocity_old = s.d.copy(), s.velocity.copy()  # no step is under way: forces are those of this instant
    f = np.zeros_like(s.d)
    if system.bodies is not None:
        s.dt = system.step.dt  # their rates are functions of it
    for load in system.loads:
        load.residual(s, f)
    for load in system.body_loads:
        load.residual(s, system.carriers, f)
    if not whole(f):
        raise blame(system, "residual")
    if system.bodies is not None or system.ties is not None:
        _with_ties(system, route, f)
        return
    fu, free = s.layout.u(f), system.eqs.is_free[:, s.layout.displacement]
    if np.any(fu[free]):
        mass = Mass([g for g in system.groups if g.moves])
        a = mass.solve(fu, free)
        left = np.where(free, fu - mass @ a, 0.0)
        if not np.linalg.norm(left) <= ENOUGH * np.linalg.norm(fu[free]):
            raise LinearError("the mass is singular for the forces at the start: let these grow from zero")
        s.acceleration[free] = a[free]


def _with_ties(system: System, route: Route, f: NDArray[np.float64]) -> None:
    """As above, with rigid bodies and nodes that depend on others."""
    s, bodies = system.state, system.bodies
    if bodies is not None:
        bodies.inertia_forces(s, f, system.alpham)
    if system.ties is not None:
        system.ties.gather(s, f, system.alphaf)
    rows, R = system.eqs.rows, system.gather(f)
    if not len(rows) or not np.any(R[rows]):
        return
    solver = route.solver(route.options.linear)
    solver.factor(system.mass_matrix())
    a = np.zeros(system.eqs.n)
    a[rows] = solver.solve(R[rows])
    solver.close()
    full = np.zeros_like(s.d)
    system.spread(a, full)
    s.acceleration[:] = s.layout.u(full)
    if bodies is not None:
        s.acceleration[bodies.nodes] = s.acceleration[bodies.owner[bodies.nodes]]
