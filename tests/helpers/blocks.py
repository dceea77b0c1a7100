"""Rigid boxes, alone or with a soft cube between them, as the solver takes them."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.solver.group import Group
from febkit.solver.problem import DYNAMIC, Attached, Block, NewtonOptions, Problem, Step
from febkit.solver.rigid import rotation
from febkit.solver.rigid.bodies import Bodies
from febkit.solver.rigid.body import Part, RigidBody
from febkit.solver.schedule import Schedule
from febkit.solver.solids.inert import Inert
from febkit.solver.solids.neo_hookean import NeoHookean
from febkit.solver.state import State
from febkit.solver.system import System
from febkit.solver.threads import Team

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
NO_NODES = np.zeros(0, np.int64)


def box(name: str, first: int, X: np.ndarray, density: float = 1.0, centre: Any = None) -> RigidBody:
    """A body of one hexahedron."""
    block = Block(name, "hex8", np.arange(first, first + 8)[None], np.array([1]), Inert(density_=density))
    return RigidBody(name, [Part(block, X)], centre)


def two_boxes(**step: Any) -> Problem:
    """Boxes of 1 x 2 x 3 and of 2 x 1 x 1, apart."""
    X = np.vstack([CORNERS * (1, 2, 3), CORNERS * (2, 1, 1) + (4, 0, 1)])
    bodies = [box("first", 0, X), box("second", 8, X, density=2.0)]
    return Problem(X, [], [Step(**step)], bodies=bodies)


def held_cube(**step: Any) -> Problem:
    """A soft cube between two rigid boxes: the bottom nodes are of the first, top ones attached to the second."""
    X = np.vstack([CORNERS - (0, 0, 1), CORNERS[4:], np.array([0.2, 0.1, 2.0]) + CORNERS])
    cube = np.array([[4, 5, 6, 7, 8, 9, 10, 11]])
    soft = Block("cube", "hex8", cube, np.array([1]), NeoHookean(E=3.0, v=0.3))
    bodies = [box("below", 0, X), box("above", 12, X)]
    return Problem(X, [soft], [Step(attached=[Attached(1, np.arange(8, 11))], **step)], bodies=bodies)


def system(problem: Problem, dt: float = 0.1) -> System:
    """A problem's first step, about to be solved."""
    state = State.at_rest(problem)
    groups = [Group(b, problem.X, 64) for b in problem.blocks]
    s = System(problem, problem.steps[0], groups, state, Schedule(groups, Team(1)), Bodies(problem, state))
    state.time = state.dt = dt
    return s


def shaken(s: System, amount: float = 0.1, seed: int = 2) -> None:
    """Move the unknowns at random, as one increment."""
    u = amount * np.random.default_rng(seed).normal(size=s.eqs.n)
    zero = np.zeros(s.eqs.n)
    s.set(s.gather(s.state.d), zero, u, s.targets(s.state.time))


def settle(s: System) -> None:
    """The present state becomes the last converged one."""
    q = s.state
    q.d_old = q.d.copy()
    q.velocity_old, q.acceleration_old = q.velocity.copy(), q.acceleration.copy()
    assert s.bodies is not None
    s.bodies.begin_step(q, s)


def _since(q: np.ndarray, old: np.ndarray) -> np.ndarray:
    """The rotation that takes an earlier one to q."""
    return rotation.unit(rotation.product(q, rotation.conjugate(old)))


def measured(s: System, h: float = 1e-6) -> np.ndarray:
    """-dR / du by central differences, rotations composed onto the present ones."""
    n, q, bodies = s.eqs.n, s.state, s.bodies
    assert bodies is not None
    base, so_far, out = s.gather(q.d_old), s.gather(q.d) - s.gather(q.d_old), np.zeros((n, n))
    for i, r in enumerate(bodies.rows + 1):
        e = s.eqs.eq[r, :3]
        so_far[e[e >= 0]] = rotation.cayley(_since(q.extra["q"][i], q.extra["q_old"][i]))[e >= 0]

    def residual(u: np.ndarray) -> np.ndarray:
        s.set(base, so_far, u, s.targets(q.time))
        return s.residual()

    for k in range(n):
        u = np.zeros(n)
        u[k] = h
        out[:, k] = -(residual(u) - residual(-u)) / (2 * h)
    residual(np.zeros(n))
    return out


def assembled(s: System) -> np.ndarray:
    """The tangent as a full matrix."""
    A, _ = s.tangent(np.zeros(s.eqs.n))
    full = np.zeros((A.n, A.n))
    for r in range(A.n):
        full[r, A.indices[A.indptr[r] : A.indptr[r + 1]]] = A.data[A.indptr[r] : A.indptr[r + 1]]
    return np.triu(full) + np.triu(full, 1).T if A.symmetric else full


def dynamic(rho: float = -2.0, **other: Any) -> dict[str, Any]:
    tight = NewtonOptions(
        method="full Newton", updates=0, dtol=1e-10, etol=0.0, line_tolerance=0.0, rho_inf=rho, max_reforms=40,
        min_residual=1e-25, diverge_reform=False,
    )
    return dict(analysis=DYNAMIC, newton=tight, **other)
