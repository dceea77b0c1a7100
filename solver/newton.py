"""One nonlinear solve: FEBio's quasi-Newton loop with line search and its convergence tests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import guarded
from .clock import Clock
from .finite import NotFinite, blame, node, whole
from .group import NegativeJacobian
from .inverse import Inverse
from .linear.base import LinearError, LinearSolver, Matrix
from .pattern import GIVEN
from .quasi_newton import METHODS, Anderson, FullNewton
from .system import System
from .vectors import dot

Floats = NDArray[np.float64]


CALM = 3  # easy steps before an old factorisation is tried: in a violent phase the answer hangs on the step sizes
EASY = 8  # iterations up to which FEBio's stepper grows the step at its full rate: within, ours is the same


class NotConverged(RuntimeError):
    """This time step did not converge; the message says why, in words for the user."""


@dataclass(slots=True)
class Norm:
    initial: float
    now: float
    required: float


@dataclass(slots=True)
class Iteration:
    """What one iteration reports: counters, line search step and norms (squared, as FEBio prints them)."""

    time: float
    number: int
    updates: int
    residuals: int
    reforms: int
    line: float
    norms: dict[str, Norm]


@dataclass(slots=True)
class Counts:
    iterations: int = 0
    residuals: int = 0
    reforms: int = 0
    factorisations: int = 0
    augmentations: int = 0


@dataclass(slots=True)
class Norms:
    energy0: float = 0.0
    energy_max: float = 0.0
    residual0: float = 0.0
    fields: list[float] = field(default_factory=list)


class Newton:
    """Solves time steps of one system; keeps the factored tangent between them."""

    def __init__(
        self, system: System, make_solver: Callable[[], LinearSolver], watch: Callable[[Iteration], None],
        clock: Clock | None = None, reuse: bool = False,
    ) -> None:
        self.system, self.watch, self.clock = system, watch, clock or Clock()
        self.inverse = Inverse(make_solver, self.clock)
        self.options = system.step.newton
        method = METHODS.get(self.options.method, FullNewton)
        if self.options.updates == 0:
            method = FullNewton
        self.reuse = reuse and method is not FullNewton
        self._fresh_qn: Any = method(lambda b: self.on_rows(self.inverse.solve, b), self.options)
        self._anderson = Anderson(lambda b: self.on_rows(self.inverse.once, b), self.options)
        self.qn: Any = self._fresh_qn
        self._stale = False
        self._calm = 0  # steps since one that was hard
        self._left = np.inf  # last increment over the one allowed
        self._renewed = False  # the present step began with an old factorisation, and made one of its own
        self.force_reform = True
        self.leans = True  # False while a step is tried again for which an old factorisation did not serve
        self.guarded = False  # the present step is solved by guarded Newton steps (:mod:`.guarded`)
        eqs = system.eqs
        self.rows, self.given = eqs.rows, eqs.given
        self.fields = [(f, system.layout.equations(f, eqs.column)) for f in system.layout.fields]
        # FEBio's norms of mixtures count a rigid body's displacement once for each node it carries, its rotation never
        self.weight: Floats | None = None
        if len(self.fields) > 1 and system.bodies is not None:
            self.weight = np.sqrt(system.bodies.counted(eqs))
        self.total = system.gather(system.state.d).copy()
        self.count = Counts()
        self.augments = any(g.physics.augments for g in system.groups) or any(a.augments for a in system.acting)

    # ---- pieces -----------------------------------------------------------------------------------
    def on_rows(self, solve: Callable[[Floats], Floats], b: Floats) -> Floats:
        """Solve for the free unknowns; prescribed ones keep b."""
        x = b.copy()
        if len(self.rows):
            x[self.rows] = solve(b[self.rows])
        return x

    def tangent(self, step: Floats) -> tuple[Matrix, Floats]:
        with self.clock("tangent"):
            A, Fd = self.system.tangent(step)
        if not whole(A.data):
            raise blame(self.system, "tangent")
        return A, Fd

    def _reform(self, step: Floats) -> Floats:
        """Renew the tangent and its inverse; returns minus its prescribed columns times ``step``."""
        A, Fd = self.tangent(step)
        self.invert(A)
        self._stale = False
        return Fd

    def invert(self, A: Matrix) -> None:
        if self.count.reforms >= self.options.max_reforms and not self.guarded:
            raise NotConverged(f"the most stiffness reformations ({self.options.max_reforms}) were reached")
        dt = self.system.state.dt
        if A.n and not (self.reuse and self.inverse.approach(A, dt)):
            self.inverse.factorise(A, dt)
        self.count.reforms += 1
        self.qn.reset()

    # ---- factorisations used again ----------------------------------------------------------------
    @property
    def stale(self) -> bool:
        """True where the present step leans on a factorisation of an earlier one."""
        return self._stale

    def _start(self, du: Floats) -> tuple[Floats, Floats | None]:
        """Residual with prescribed increments at the start of a step, and a direction where one is found."""
        self._stale = False
        if not self.reuse:
            Fd = self._reform(du)
            return self.residual() + Fd, None
        A, Fd = self.tangent(du)
        R0, dt = self.residual() + Fd, self.system.state.dt
        fresh = self.force_reform or not self.leans or self._calm < CALM
        kept = None if fresh else self.inverse.near(dt)
        if kept is not None:
            u, z = R0.copy(), R0.copy()
            first, z[self.rows] = self.inverse.lean_on(kept, A, dt, R0[self.rows])
            if first is not None:
                self._stale, self.qn = True, self._anderson
                self.qn.reset()
                self._anderson.first(z)
                u[self.rows] = first
                return R0, u
        self.qn = self._fresh_qn
        self.invert(A)
        return R0, self.on_rows(self.inverse.refined, R0)

    def targets(self) -> Floats:
        """Values (node, column) that prescribed unknowns take in the present step; NaN elsewhere."""
        out = self.system.targets(self.system.state.time)
        bad = np.argwhere((self.system.eqs.kind == GIVEN) & ~np.isfinite(out))
        if len(bad):
            row, column = (int(i) for i in bad[0])
            where = node(self.system.problem, row)
            raise NotFinite(f"the {self.system.layout.label(column)} prescribed on {where} is {out[row, column]:g}")
        return out

    def residual(self) -> Floats:
        self.count.residuals += 1
        with self.clock("residual"):
            R = self.system.residual()
        if not (self.system.finite and whole(R)):
            raise blame(self.system, "residual")
        return R

    def _move(self, u: Floats) -> None:
        with self.clock("stress update"):
            self.system.set(self.total, self.increment, u, self.target)

    def snapshot(self) -> Floats:
        """The unknowns at the last converged state."""
        return self.total.copy()

    def restore(self, saved: Floats) -> None:
        self.total = saved.copy()

    def close(self) -> None:
        """Free all factorisations."""
        self.inverse.close()

    # ---- line search ------------------------------------------------------------------------------
    def _line_search(self, u: Floats, R0: Floats) -> tuple[float, Floats]:
        """Step length s with |u . R(s)| < lstol |u . R(0)| (FEBio's cubic of the energy), and R there."""
        o = self.options
        if o.line_tolerance <= 0 or self._stale:  # multisecant directions are no descent directions
            self._move(u)
            return 1.0, self.residual()
        s = best = 1.0
        r0 = dot(u, R0)
        least = abs(r0)
        n = 0
        while True:
            s = self._try(u, s)
            R1 = self.residual()
            if s < o.line_minimum and not o.line_check_jacobians:
                self._move(0.5 * u)
                return 0.5, self.residual()
            r1 = dot(u, R1)
            if n == 0 or abs(r1) < least:
                best, least = s, abs(r1)
            r = 0.0 if abs(r1) < 1e-17 else abs(r1 / r0) if r0 else np.inf
            if not r > o.line_tolerance:
                return s, R1
            s = self._next(s, r0 / r1)
            n += 1
            if n >= o.line_iterations:
                self._move(best * u)
                return best, self.residual()

    @staticmethod
    def _next(s: float, a: float) -> float:
        A = 1 + a * (s - 1)
        B = a * s * s
        D = B * B - 4 * A * B
        if A == 0:
            return 0.0
        if D < 0:
            return 0.5 * B / A
        root = np.sqrt(D)
        s = (B + root) / (2 * A)
        if s < 0:
            s = (B - root) / (2 * A)
        return max(s, 0.0)

    def _try(self, u: Floats, s: float) -> float:
        if not self.options.line_check_jacobians:
            self._move(s * u)
            return s
        for n in range(self.options.line_iterations + 2):
            try:
                self._move(s * u)
                return s
            except NegativeJacobian:
                if n > self.options.line_iterations:
                    raise
                s *= 0.5
        return s

    # ---- the loop ---------------------------------------------------------------------------------
    def step(self) -> Counts:
        """Solve the present time step. Raises NotConverged, NotFinite, ElementFailure or LinearError."""
        self.count, self._renewed, self._left = Counts(), False, np.inf
        made = self.inverse.made
        try:
            guarded.solve(self) if self.guarded else self._solve_step()
        finally:
            self.count.factorisations = self.inverse.made - made
        self.total = self.total + self.increment
        if self.system.dry is not None:
            self.total[self.system.dry] = 0.0
        self._calm = 0 if self._renewed or self.count.iterations > EASY else self._calm + 1
        return self.count

    def _solve_step(self) -> None:
        sys_, o = self.system, self.options
        self.increment = np.zeros_like(self.total)
        self.target = self.targets()
        du = np.zeros_like(self.total)
        given = sys_.gather(self.target) - sys_.gather(sys_.state.d)
        du[self.given] = given[self.given]
        sys_.progress.iterations = sys_.progress.augmentations = 0
        sys_.update()
        self.qn.reset() if self.force_reform or o.reform_each_step else None
        self.qn.begin()
        R0, u = self._start(du)
        self.force_reform = False
        norms = Norms()
        while not self._iterate(R0, norms, u):
            R0, u = self._next_R0, None
            sys_.progress.iterations = self.count.iterations

    def _iterate(self, R0: Floats, m: Norms, u: Floats | None = None) -> bool:
        o, k = self.options, self.count
        if u is None:
            u = self.qn.solve(R0)
        if not np.isfinite(u).all():
            raise NotConverged("the solution of the linear system is not finite (singular tangent?)")
        s, R1 = self._line_search(u, R0)
        report, converged = self.judge(u, s, R0, R1, m)
        energy, r1 = report["energy"].now, report["residual"].now
        if not converged and 0 < o.max_residual <= r1:
            raise NotConverged(f"the residual {r1:g} is above max_residual = {o.max_residual:g}")
        if converged:
            converged = not self.augments or self.augment()
            k.iterations += 1
            return converged
        if o.line_tolerance > 0 and s < o.line_minimum:
            self.force_reform = True
        elif energy > m.energy_max and o.diverge_reform:
            m.energy_max = m.energy0 = energy
            m.residual0 = r1
            self.force_reform = True
        self._update(s, u, R0, R1, report)
        k.iterations += 1
        return False

    def judge(
        self, u: Floats, s: float, R0: Floats, R1: Floats, m: Norms
    ) -> tuple[dict[str, Norm], bool]:
        """Take the step s u from residual R0 to R1; report its norms, and whether they are small enough."""
        k = self.count
        if k.iterations == 0:
            m.residual0, m.energy0 = dot(R0, R0), abs(dot(u, R0))
            m.energy_max = m.energy0
            m.fields = [self._square(u, own) for _, own in self.fields]
        self.increment = self.system.compose(self.increment, s * u)
        report, converged = self._test(u, s, R1, m)
        for name, norm in report.items():  # of numbers too large to be squared: no test on them means anything
            if not (isfinite(norm.initial) and isfinite(norm.now)):
                raise NotFinite(f"the norm of {'the ' + name} overflows: the numbers of the model are too large")
        self.watch(Iteration(
            self.system.state.time, k.iterations + 1, self.qn.count, k.residuals, k.reforms, s, report
        ))  # fmt: skip
        return report, converged or report["residual"].now < self.options.min_residual

    def _test(self, u: Floats, s: float, R1: Floats, m: Norms) -> tuple[dict[str, Norm], bool]:
        o, U = self.options, self.increment
        energy, r1 = abs(s * dot(u, R1)), dot(R1, R1)
        report = {
            "residual": Norm(m.residual0, r1, o.rtol * m.residual0),
            "energy": Norm(m.energy0, energy, o.etol * m.energy0),
        }
        ok = not (o.rtol > 0 and r1 > o.rtol * m.residual0)
        ok = ok and not (o.etol > 0 and energy > o.etol * m.energy0)
        for (f, own), first in zip(self.fields, m.fields):
            tol, now, total = o.tolerance(f), s * s * self._square(u, own), self._square(U, own)
            report[f.name] = Norm(first, now, tol * tol * total)
            ok = ok and not (tol > 0 and now > tol * tol * total)
        ok = ok and not (o.line_tolerance > 0 and s < o.line_minimum)
        ok = ok and not (o.diverge_reform and energy > m.energy_max)
        # surfaces that met while nothing else moved: an increment of zero is no sign of balance
        ok = ok and not (self.system.contacts and r1 > m.residual0 and not U.any())
        return report, ok

    def _square(self, u: Floats, own: NDArray[np.int64]) -> float:
        """Squared norm of a field's equations ``own``."""
        part = u[own] if self.weight is None else u[own] * self.weight[own]
        return dot(part, part)

    def _slow(self, report: dict[str, Norm]) -> bool:
        """Would an old factorisation take more iterations than a new one is worth?

        The iterations still needed are extrapolated from the last two increments.
        """
        done, left = self.count.iterations + 1, [
            np.sqrt(n.now / n.required) for k, n in report.items() if k not in ("residual", "energy") and n.required > 0
        ]  # fmt: skip
        before, self._left = self._left, max(left, default=1.0)
        if done < 2 or self._left <= 1.0:
            return done >= self.inverse.worth
        rate = self._left / before
        return rate >= 0.9 or done + np.log(self._left) / -np.log(rate) > self.inverse.worth

    def _update(self, s: float, u: Floats, R0: Floats, R1: Floats, report: dict[str, Norm]) -> None:
        reform, self.force_reform = self.force_reform, False
        if self._stale and reform:
            raise NotConverged("the factorisation of an earlier step did not serve")
        if self._stale and self._slow(report):
            self._renewed, reform, self.qn = True, True, self._fresh_qn
        if reform or not self.qn.update(s, u, R0, R1):
            self._reform(np.zeros_like(u))
        self._next_R0 = R1

    def augment(self) -> bool:
        k, system = self.count, self.system
        done = [g.physics.augment(k.augmentations) for g in system.groups]
        done += [a.augment(k.augmentations, system.state) for a in system.acting]
        k.augmentations += 1
        system.progress.augmentations = k.augmentations
        k.reforms = 0
        if all(done):
            return True
        self.system.update()
        self._next_R0 = self.residual()
        self.qn.begin()
        if self.options.updates == 0 or self.options.reform_augment:
            self._reform(np.zeros_like(self.total))
        return False


__all__ = ["Counts", "Iteration", "LinearError", "Newton", "NotConverged"]
