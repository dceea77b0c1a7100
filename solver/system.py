"""Residual and tangent of one analysis step over all groups, loads and conditions."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from .action import Action
from .fields import ROTATION
from .finite import whole
from .graph import Graph, MakeGraph
from .group import Group
from .kernels import vectors
from .kernels.pattern import scatter_any, uncouple
from .law import PoreCollapse
from .linear.base import Matrix
from .mass import Mass
from .pattern import FREE, HELD, INACTIVE, Equations, Pattern
from .problem import DYNAMIC, STEADY, Prescribed, Problem, Progress, Step
from .schedule import Schedule, Share
from .state import State
from .tangent import Target, Workspace

if TYPE_CHECKING:
    from .following import Following
    from .rigid.bodies import Bodies
    from .rotations import Rotations
    from .ties import Constraints, Ties

Floats = NDArray[np.float64]


class System:
    """The equations of one analysis step.

    Vectors over equations hold free and prescribed unknowns alike, node by node; a prescribed entry of
    a residual and of an increment is zero.
    """

    def __init__(
        self, problem: Problem, step: Step, groups: list[Group], state: State, schedule: Schedule,
        bodies: Bodies | None = None, graph: MakeGraph = Graph,
    ) -> None:  # fmt: skip
        self.problem, self.step, self.groups, self.state, self.schedule = problem, step, groups, state, schedule
        self.layout = state.layout
        self.bodies, self._graph = bodies, graph
        if bodies is not None:
            bodies.attach(state, [*problem.common.attached, *step.attached])
        self.conditions = [*problem.common.conditions, *step.conditions]
        self.loads = [*problem.common.loads, *step.loads]
        self.body_loads = [*problem.common.body_loads, *step.body_loads]
        self.following = [cast("Following", c) for c in self.conditions if isinstance(c, Prescribed) and c.follows]
        for c in self.following:
            c.begin(groups)
        self._link()
        self.ties = self._tie()
        self.contacts = [*problem.common.contacts, *step.contacts]
        self.progress = Progress()
        self.dry: NDArray[np.int64] | None = None  # equations that contact holds at ambient values
        self.finite = True  # all forces of the last residual were
        self.join: Callable[[Floats, Floats], Floats] | None = None  # residual of internal forces and others; None: sum
        self.eqs = Equations(self._active(), self.conditions)
        self.rotations = self._turn()
        self.dynamic = step.analysis == DYNAMIC
        self.steady = step.analysis == STEADY
        for a in self.acting:
            a.steady = self.steady
        self._begin_conditions()
        self.symmetric = self._symmetric()
        self.carriers = [*groups, *bodies.parts] if bodies is not None else groups  # what body loads act on
        self._pattern: Pattern | None = None
        self._met: list[NDArray[np.int32]] = []
        self._R = [np.zeros_like(state.d) for _ in range(schedule.n)]
        self._work = [Workspace() for _ in range(schedule.n)]
        self.alphaf, self.alpham, self.beta, self.gamma = self._integrator()
        for a in self.acting:
            a.alpha = self.alphaf
        for b in self.body_loads:
            # velocities follow displacements by Newmark's rule, beside other fields by backward Euler, or not at all
            b.rate = self.gamma / self.beta if self.dynamic else float(self.layout.mixed)
        for g in groups:
            g.alphaf = self.alphaf if g.shell or g.physics.spins else 1.0
            g.steady = self.steady
        self._mass: Mass | None = None

    @property
    def acting(self) -> list[Action]:
        """All that acts on the nodes beside the elements."""
        return [*self.loads, *self.body_loads, *self.contacts]

    def _link(self) -> None:
        """The connectors of the step are among its loads."""
        c = self.bodies.connectors if self.bodies is not None else None
        active = [*self.problem.common.connectors, *self.step.connectors]
        if c is not None and active:
            c.take(active, self)
            self.loads.append(c)

    def _tie(self) -> Ties | None:
        """Carried nodes of rigid bodies, and linear constraints."""
        records = [*self.problem.common.constraints, *self.step.constraints]
        self.constraints: Constraints | None = None
        if records:
            from .ties import Constraints

            self.constraints = Constraints(records, self.layout)
        sources: list[Bodies | Constraints] = [q for q in (self.bodies, self.constraints) if q is not None]
        if not sources:
            return None
        from .ties import Ties

        return Ties(sources, self.state)

    def _turn(self) -> Rotations | None:
        """Rotations of the nodes, where there are any."""
        if not self.layout.turns:
            return None
        from .rotations import Rotations

        own, kind = self.layout[ROTATION.name], self.eqs.kind
        nodes = np.flatnonzero((kind[:, own] != INACTIVE).any(axis=1))
        return Rotations(self.state, own, nodes, kind[:, own] == FREE, self.eqs.eq[:, own])

    def _active(self) -> NDArray[np.bool_]:
        active, u = np.zeros(self.state.d.shape, bool), self.layout.displacement
        for g in self.groups:
            own = np.zeros(len(active), bool)
            own[g.conn if g.alive.all() else g.conn[g.alive]] = True
            active[np.ix_(own, g.columns)] = True
        for a in self.acting:
            active[a.joins[:, None], u] = True
        if self.bodies is not None:
            active[len(self.problem.X) :, u] = True
        if self.ties is not None:
            active.reshape(-1)[self.ties.own] = False
        return active

    def _begin_conditions(self) -> None:
        """Fixed unknowns of nodes go to zero; relative conditions remember where they start."""
        n = len(self.problem.X)
        self.state.d[:n][self.eqs.kind[:n] == HELD] = 0.0
        self._start = [
            self.state.d[c.nodes, c.column].copy() if isinstance(c, Prescribed) and c.relative else None
            for c in self.conditions
        ]

    def _symmetric(self) -> bool:
        asked = self.step.newton.symmetric
        if asked:
            return True
        own = all(g.physics.symmetric(self.steady) for g in self.groups)
        if self.bodies is not None and self.dynamic:
            return False  # rotational inertia is not
        if self.body_loads and any(g.physics.swells() for g in self.groups):
            return False
        return own and all(a.symmetric for a in self.acting)

    def _integrator(self) -> tuple[float, float, float, float]:
        """Newmark / generalised-alpha parameters (FEBio user manual, rhoi, alpha, beta, gamma)."""
        o = self.step.newton
        if not self.dynamic:
            return 1.0, 1.0, o.beta, o.gamma
        if o.rho_inf == -1:
            af = am = 1.0
        elif 0 <= o.rho_inf <= 1:
            af, am = 1 / (1 + o.rho_inf), (2 - o.rho_inf) / (1 + o.rho_inf)
        else:
            return o.alpha, o.alpha, o.beta, o.gamma
        return af, am, (1 + am - af) ** 2 / 4, 0.5 + am - af

    @property
    def mixed(self) -> bool:
        """Are there several fields or penalties, so that pivots of very different size are sound?"""
        return self.layout.mixed or any(a.augments for a in self.loads) or bool(self.contacts)

    @property
    def pattern(self) -> Pattern:
        if self._pattern is None or self.contacts:
            met = [np.asarray(q, np.int32) for c in self.contacts for q in c.cliques()]
            if self._pattern is None or not self._pattern.holds(met):
                return self._weave(met)
        return self._pattern

    def _weave(self, met: list[NDArray[np.int32]]) -> Pattern:
        """The pattern where surfaces in contact couple the nodes ``met`` (m, n), padded with -1."""
        cliques = [*(q for a in self.loads for q in a.cliques()), *met]
        cliques += [q for g in self.groups for q in g.physics.cliques()]
        if self.bodies is not None:
            cliques += self.bodies.cliques()
        rest = self.schedule, self.ties, self._graph
        self._met, self._pattern = met, Pattern(self.eqs, self.groups, cliques, self.symmetric, *rest)
        self._matrix = self._pattern.matrix()
        return self._pattern

    @property
    def matrix(self) -> Matrix:
        """The matrix that tangents are assembled into."""
        _ = self.pattern
        return self._matrix

    def snapshot(self) -> dict[str, Any]:
        """What outlasts a time step, for a run that goes on from a checkpoint."""
        return {"met": list(self._met), "followed": [c.last for c in self.following]}

    def restore(self, saved: dict[str, Any]) -> None:
        if saved["met"]:
            self._weave(saved["met"])
        for c, last in zip(self.following, saved["followed"], strict=True):
            c.last = last

    # ---- values -----------------------------------------------------------------------------------
    def targets(self, t: float) -> Floats:
        """Values (node, column) that prescribed unknowns take at time t; NaN elsewhere."""
        out = np.full(self.state.d.shape, np.nan)
        for c, start in zip(self.conditions, self._start):
            if isinstance(c, Prescribed) and c.follows:
                last = cast("Following", c).last
                out[c.nodes, c.column] = self.state.d[c.nodes, c.column] if last is None else last
            elif isinstance(c, Prescribed):
                v = c.value(t, self.state.X[c.nodes], np.arange(len(c.nodes)))
                out[c.nodes, c.column] = v if start is None else v + start
        np.copyto(out, np.nan, where=self.eqs.not_given)
        return out

    def gather(self, nodal: Floats) -> Floats:
        out = np.empty(self.eqs.n)
        vectors.gather(self.eqs.eq, nodal, out)
        return out

    def spread(self, vector: Floats, into: Floats) -> None:
        """Write the free entries of an equation vector to a nodal array."""
        vectors.put(self.eqs.free_places, self.eqs.rows, vector, into.reshape(-1))

    # ---- state ------------------------------------------------------------------------------------
    def set(self, total: Floats, increment: Floats, u: Floats, target: Floats) -> None:
        """Move the state as :meth:`place` does; update stresses."""
        self.place(total, increment, u, target)
        self.update()

    def place(self, total: Floats, increment: Floats, u: Floats, target: Floats) -> None:
        """Move the state to free unknowns ``total`` + ``increment`` + ``u``, given ones to ``target``.

        ``increment`` is that of the step so far, to which ``u`` is added (rotations of rigid bodies: composed).
        """
        s = self.state
        followed = []
        if self.following:
            given = self.eqs.is_given
            s.d[given] = target[given]
            followed = [c.values(s) for c in self.following]
        vectors.place(self.eqs.eq, self.eqs.free, total, increment, u, target, s.d)
        self._keep_positive()
        self._drain()
        for c, v in zip(self.following, followed, strict=True):
            mine = self.eqs.is_given[c.nodes, c.column]
            s.d[c.nodes[mine], c.column] = v[mine]
        if self.bodies is not None:
            self.bodies.move(s, self.eqs, increment, u)
        if self.rotations is not None:
            self.rotations.move(s, increment, u)
        if self.constraints is not None:
            self.constraints.enforce(s)
        self.set_rates()

    def _keep_positive(self) -> None:
        """Free concentrations below zero are taken as zero; the equations keep what they had (as in FEBio)."""
        own = self.state.layout.concentrations if self.step.newton.positive else ()
        for column in own:
            c = self.state.d[:, column]
            c[(c < 0.0) & self.eqs.is_free[:, column]] = 0.0

    def compose(self, a: Floats, b: Floats) -> Floats:
        """The increment a, then b."""
        total = a + b
        if self.rotations is not None:
            self.rotations.compose(total, a, b)
        return total if self.bodies is None else self.bodies.compose(self.eqs, total, a, b)

    def accumulate(self, total: Floats, increment: Floats) -> Floats:
        """The unknowns at the end of a step of ``increment``; rotations of bodies are not had from these."""
        out = total + increment
        return out if self.rotations is None else self.rotations.compose(out, total, increment)

    def settle(self) -> None:
        """The state after an iteration is the one that the next iteration's increments start from."""
        if self.rotations is not None:
            self.rotations.settle(self.state)
            for g in self.groups:
                g.physics.settle()

    def set_rates(self) -> None:
        """Velocities and accelerations at the present nodal values."""
        s = self.state
        if self.dynamic:
            du = s.u - s.u_old
            a = 1.0 / (self.beta * s.dt)
            s.acceleration = du * (a / s.dt) - s.velocity_old * a + s.acceleration_old * (1 - 0.5 / self.beta)
            s.velocity = s.velocity_old + s.dt * (
                (1 - self.gamma) * s.acceleration_old + self.gamma * s.acceleration
            )
        elif s.layout.mixed and s.dt > 0:
            s.velocity = np.zeros(s.velocity.shape)
            vectors.rates(s.d, s.d_old, s.layout.displacement, s.dt, s.velocity)
        if self.bodies is not None:
            self.bodies.rates(s, self)
        if self.rotations is not None and self.dynamic:
            self.rotations.rates(s, (self.beta, self.gamma))

    def update(self) -> None:
        """Kinematics, stresses and fluxes at the present state, and then contacts.

        What contacts hold at ambient values from now on the elements see in the next update, as in FEBio.
        """
        s = self.state
        u = s.u if self.alphaf == 1.0 else self.alphaf * s.u + (1 - self.alphaf) * s.u_old
        drive = [b for b in self.body_loads if b.drives]

        def work(share: Share) -> None:
            for g, c in share.chunks:
                g.update(c, s, u, drive)

        self.schedule.map(work)
        for g in self.groups:
            if g.physics.collects:
                g.physics.collect(s)
        if self.alphaf != 1.0 and s.dt > 0:
            for g in self.groups:
                g.physics.end(s, self.alphaf)
        for contact in self.contacts:
            contact.update(s, self.progress)
        if any(c.drains for c in self.contacts):
            self._find_dry()
            self._drain()

    def _find_dry(self) -> None:
        """Free pressures and concentrations of surfaces that touch nothing: what surrounds them holds them."""
        shape = self.state.d.shape
        dry, wet, ambient = np.zeros(shape, bool), np.zeros(shape, bool), np.zeros(shape)
        for contact in self.contacts:
            if contact.drains:
                nodes, touching = contact.drained(self.state)
                for field, value in contact.ambient(self.state).items():
                    (column,) = self.layout.columns(field)
                    dry[nodes, column], ambient[nodes, column] = True, value
                    wet[touching, column] = True
        dry &= ~wet & self.eqs.is_free
        self.dry, self.ambient = self.eqs.eq[dry].astype(np.int64), ambient[dry]
        self._dry_places = dry

    def _drain(self) -> None:
        if self.dry is not None:
            self.state.d[self._dry_places] = self.ambient

    # ---- residual ---------------------------------------------------------------------------------
    def residual(self) -> Floats:
        """External minus internal forces over the equations (zero where prescribed)."""
        s = self.state

        def work(share: Share) -> None:
            R = self._R[share.thread]
            R[:] = 0.0
            for g, lo, hi in share.spans:
                g.physics.residual(lo, hi, s, R, self.steady)

        self.schedule.map(work)
        total = self._R[0]
        for R in self._R[1:]:
            total += R
        if self.layout.moves:
            s.reaction = -self.layout.u(total)
        if self.join is None:
            self.add_external(total)
            return self._over(total)
        external = np.zeros_like(total)
        self.add_external(external)
        parts = self._over(total), self._over(external)
        self.finite = whole(total) and whole(external)
        return self.join(*parts)

    def _over(self, total: Floats) -> Floats:
        """Nodal forces over the equations."""
        if self.ties is not None:
            self.ties.gather(self.state, total, self.alphaf)
        self.finite = whole(total)  # forces at held and prescribed unknowns too, which no norm sees
        out = self.gather(total)
        out[self.eqs.given] = 0.0
        if self.dry is not None:
            out[self.dry] = 0.0
        return out

    def add_external(self, total: Floats) -> None:
        """Add the forces of all but the stresses: loads, contacts, inertia."""
        s = self.state
        for load in self.loads:
            load.residual(s, total)
        for load in self.body_loads:
            load.residual(s, self.carriers, total)
        for contact in self.contacts:
            contact.residual(s, total)
        if self.dynamic:
            self._inertia(total)

    def _inertia(self, total: Floats) -> None:
        s = self.state
        a = self.alpham * s.acceleration + (1 - self.alpham) * s.acceleration_old
        Ru = self.layout.u(total)
        Ru -= self.mass @ a
        if self.bodies is not None:
            self.bodies.inertia_forces(s, total, self.alpham)
        for g in self.groups:
            g.physics.inertia(s, total)

    @property
    def mass(self) -> Mass:
        """Consistent mass by referential density."""
        if self._mass is None:
            self._mass = Mass([g for g in self.groups if g.moves and not g.physics.spins])
        return self._mass

    # ---- tangent ----------------------------------------------------------------------------------
    def tangent(self, step: Floats) -> tuple[Matrix, Floats]:
        """The tangent, and minus its prescribed columns times the increments ``step`` (equations)."""
        pat, Fd = self.pattern, np.zeros(self.eqs.n)
        A = self._matrix
        A.data[:] = 0.0
        if self.ties is not None:
            self.ties.aim(self.state, self.alphaf)
        rows, tied = np.zeros(A.n), np.zeros(self.eqs.n if self.ties is not None else 0)
        targets = [Target(pat, A, step, rows, tied, first=i == 0) for i in range(self.schedule.n)]

        def work(share: Share) -> None:
            for g, c in share.chunks:
                try:
                    g.physics.tangent(c, self.state, targets[share.thread], self._work[share.thread], self.steady)
                except PoreCollapse as e:
                    raise g.named(e) from None

        self.schedule.map(work)
        for target in targets:
            target.finish()
        Fd[self.eqs.rows] = rows
        if self.ties is not None:
            Fd += tied
        for g in self.groups:
            for K, nodes, columns in g.physics.couplings(self.state, A.symmetric):
                self._add(A, K, nodes, columns, step, Fd)
        if self.alphaf != 1.0:
            A.data *= self.alphaf
            Fd *= self.alphaf
        for a in self.acting:
            for K, nodes, columns in a.stiffness(self.state, self.carriers):
                self._add(A, K, nodes, columns, step, Fd)
        if self.dynamic:
            self._add_mass(A, step, Fd, self.alpham / (self.beta * self.state.dt**2))
        if self.dry is not None:
            self._uncouple(A, Fd)
        return A, Fd

    def _uncouple(self, A: Matrix, Fd: Floats) -> None:
        """Leave of the rows and columns of what is held so the diagonal alone."""
        assert self.dry is not None
        dry = np.zeros(A.n, bool)
        dry[self.eqs.free[self.dry]] = True
        uncouple(A.indptr, A.indices, A.data, dry)
        Fd[self.dry] = 0.0

    def _add(self, A: Matrix, K: Floats, nodes: NDArray, columns: NDArray, step: Floats, Fd: Floats) -> None:
        """Add matrices K (m, d, d) whose row k is unknown (nodes[:, k], columns[k])."""
        dofs = np.ascontiguousarray(self.eqs.eq[nodes, columns], dtype=np.int32)
        scatter_any(
            np.ascontiguousarray(K), dofs, self.eqs.free, A.indptr, A.indices, A.data, step, Fd, A.symmetric
        )
        if self.ties is not None:
            some = self.ties.rows(nodes)
            if len(some):
                self.ties.scatter(self.eqs, A, K[some], nodes[some], columns, step, Fd)

    def mass_matrix(self) -> Matrix:
        """The mass in the tangent's pattern: what takes accelerations at the start to forces."""
        A = self.pattern.matrix()
        if self.ties is not None:
            self.ties.aim(self.state, 1.0)
        self._add_mass(A, np.zeros(self.eqs.n), np.zeros(self.eqs.n), 1.0)
        return A

    def _add_mass(self, A: Matrix, step: Floats, Fd: Floats, scale: float) -> None:
        for g, M in self.mass.parts:
            for i in self.layout.displacement:
                self._add(A, scale * M, g.conn, np.full(g.n, i), step, Fd)
        if self.bodies is not None:
            for K, nodes, columns in self.bodies.inertia_tangent(self.state, self):
                self._add(A, K, nodes, columns, step, Fd)
        for g in self.groups:
            for K, nodes, columns in g.physics.inertia_tangent(self.state, (self.beta, self.gamma)):
                self._add(A, K, nodes, columns, step, Fd)
