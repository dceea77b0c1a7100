"""A representative volume: a boundary value problem whose mean stress is that of a point of a larger one.

All displacements of its boundary are given, (F - 1) X about its middle. Its state between calls is a row of numbers
(nodal unknowns, then histories), so that a point that fails a step finds the last converged one again.
"""

from __future__ import annotations

from dataclasses import replace
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .group import ElementFailure, Group
from .linear.choose import choose
from .newton import Newton
from .points import VOIGT
from .problem import Fixed, Prescribed, Problem
from .schedule import Schedule
from .solids import history
from .state import State
from .system import System
from .threads import Team
from .values import Map

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Rve:
    """The volume of ``problem`` (one step, whose conditions are replaced) and its ``boundary`` nodes.

    ``width``: numbers of a state; ``rest``: the state (width,) before anything. One thread at a time: ``lock``.
    """

    def __init__(self, problem: Problem, boundary: Ints) -> None:
        X = problem.X - 0.5 * (problem.X.min(axis=0) + problem.X.max(axis=0))
        self.boundary, self.lock = np.asarray(boundary), Lock()
        self._given = [Map(np.zeros(len(boundary))) for _ in range(3)]
        columns = problem.layout.displacement
        pairs = zip(columns.tolist(), self._given, strict=True)
        held: list[Fixed | Prescribed] = [Prescribed(k, self.boundary, v) for k, v in pairs]
        step = replace(problem.steps[0], conditions=held)
        self.problem = replace(problem, X=X, steps=[step])
        self.state = State.at_rest(self.problem)
        self.groups = [Group(b, X, 256, self.state.layout) for b in problem.blocks]
        schedule = Schedule(self.groups, Team(1))
        bare = replace(step, conditions=[])
        self._all = System(replace(self.problem, steps=[bare]), bare, self.groups, self.state, schedule)
        self.system = System(self.problem, step, self.groups, self.state, schedule)
        rows = len(self.system.eqs.rows)
        self.newton = Newton(self.system, lambda: choose("auto", rows, 1), lambda _: None)
        self.rest = self._row()
        self.width = len(self.rest)

    @property
    def grows(self) -> bool:
        """Has it a law whose memory may grow? Its state has no fixed width then."""
        return any(history.grows(b.solid) for b in self.problem.blocks)

    # ---- states -----------------------------------------------------------------------------------
    def _row(self) -> Floats:
        return np.concatenate([self.state.d.ravel(), *(g.new.ravel() for g in self.groups)])

    def _take(self, row: Floats) -> None:
        s, at = self.state, self.state.d.size
        s.d[:] = row[:at].reshape(s.d.shape)
        s.d_old = s.d.copy()
        for g in self.groups:
            end = at + g.new.size
            g.set_history(row[at:end].reshape(g.new.shape).copy())
            at = end

    # ---- at work ----------------------------------------------------------------------------------
    def solve(self, F: Floats, start: Floats, t: float, dt: float) -> Floats:
        """Its state under F (3, 3) at the end of a step from the state ``start``. Raises what Newton's method does."""
        self._take(start)
        s, X = self.state, self.state.X[self.boundary]
        s.time, s.dt = t, dt
        for v, u in zip(self._given, (X @ (F - np.eye(3)).T).T, strict=True):
            v.data[:] = u
        for g in self.groups:
            g.begin_step(s)
        # all nodes are led along with the mean, which a rotation leaves nothing to do after
        before = np.linalg.solve(X.T @ X, X.T @ s.x[self.boundary]).T
        s.layout.u(s.d)[:] = s.x @ (F @ np.linalg.inv(before)).T - s.X
        self.newton.total = self.system.gather(s.d).copy()
        try:
            self.newton.step()
        except ElementFailure as e:
            raise ElementFailure(f"in a representative volume: {e}") from None
        return self._row()

    @property
    def volume(self) -> float:
        """Its present volume."""
        return sum(float((g.wJ0 * g.J).sum()) for g in self.groups)

    def stress(self) -> Floats:
        """Mean Cauchy stress (6,) over the present volume."""
        total = np.zeros(6)
        for g in self.groups:
            work: Any = g.physics
            total += np.einsum("eg,egk->k", g.wJ0 * g.J, work.s)
        return total / self.volume

    def energy(self) -> float:
        """Mean strain energy per reference volume. Raises NotImplementedError where a law gives none."""
        total = 0.0
        for g in self.groups:
            W = g.block.solid.energy(g.points())
            total += float((g.wJ0.ravel() * W).sum())
        return total / sum(float(g.wJ0.sum()) for g in self.groups)

    def tangent(self) -> Floats:
        """Spatial elasticity tensor (6, 6): r_k . K r_l / V - h_k s : h_l.

        r_k: what nodes do where the boundary is strained by h_k and the inside follows in equilibrium; s: the mean
        stress, whose share K (stress stiffness and all) has, and a tangent of a material has not.
        """
        from scipy.sparse import csr_array, triu
        from scipy.sparse.linalg import splu

        A, _ = self._all.tangent(np.zeros(self._all.eqs.n))
        K = csr_array((A.data, A.indices, A.indptr), shape=(A.n, A.n))
        K = K + triu(K, 1).T if A.symmetric else K
        h = np.array([0.5 * (np.outer(e, f) + np.outer(f, e)) for e, f in (np.eye(3)[list(ij)] for ij in VOIGT)])
        b = self._all.eqs.eq[np.ix_(self.boundary, self.state.layout.displacement)].ravel()
        inside = np.setdiff1d(np.arange(A.n), b)
        r = np.zeros((A.n, 6))
        r[b] = np.einsum("kij,nj->nik", h, self.state.x[self.boundary]).reshape(-1, 6)
        if len(inside):
            r[inside] = splu(K[inside][:, inside].tocsc()).solve(-(K[inside] @ r))
        s = self.stress()
        S = np.array([[s[0], s[3], s[5]], [s[3], s[1], s[4]], [s[5], s[4], s[2]]])
        return np.asarray(r.T @ (K @ r) / self.volume - np.einsum("kij,jl,mil->km", h, S, h))
