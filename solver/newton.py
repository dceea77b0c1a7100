"""Newton's method on the system of an analysis step, one time step after another; how a step is solved is a strategy.

Strategies (:mod:`.loop`, :mod:`.kept`, :mod:`.guarded`) share what is here: residuals, tangents and their inverse, the
increment so far, augmentations, and the tests of :mod:`.convergence`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .clock import Clock
from .convergence import Convergence, Iteration, Norm, NotConverged
from .finite import NotFinite, blame, node, whole
from .forecast import Guess
from .guarded import Guarded
from .inverse import FRESH, REFINED, Inverse, Use
from .kept import Kept
from .linear.base import LinearError, LinearSolver, Matrix
from .loop import Loop
from .problem import NewtonOptions
from .system import System

Floats = NDArray[np.float64]

EASY = 8  # iterations up to which FEBio's stepper grows the step at its full rate: within, ours is the same


class Strategy(Protocol):
    """A way of solving a time step. Raises NotConverged, NotFinite, ElementFailure or LinearError.

    ``stale``: the step leans on a factorisation of an earlier one; ``renewed``: it began so, and made one of its own;
    ``guessed``: it began where the last ones led.
    """

    stale: bool
    renewed: bool
    guessed: bool

    def solve(self) -> None: ...


class Along(Strategy, Protocol):
    """A strategy that goes along the path of equilibrium; ``factor``: how much of the loads acts."""

    factor: float

    def snapshot(self) -> Any: ...

    def restore(self, saved: Any) -> None: ...


@dataclass(slots=True, eq=False)
class Counts:
    """What a time step took."""

    iterations: int = 0
    residuals: int = 0
    reforms: int = 0
    factorisations: int = 0
    augmentations: int = 0


class Newton:
    """Solves time steps of one system; keeps the factored tangent between them.

    ``usual``, ``fresh`` and ``guarded`` are its strategies: the first leans on factorisations of earlier steps where
    ``use`` says so, the second makes one of its own.
    """

    def __init__(
        self, system: System, make_solver: Callable[[], LinearSolver], watch: Callable[[Iteration], None],
        clock: Clock | None = None, use: Use = FRESH, options: NewtonOptions | None = None,
    ) -> None:  # fmt: skip
        self.system, self.watch, self.clock = system, watch, clock or Clock()
        self.options = options or system.step.newton
        layout, column = system.layout, system.eqs.column[system.eqs.rows]
        fields = [layout.equations(f, column) for f in layout.normed] if layout.mixed else []
        self.inverse = Inverse(make_solver, self.clock, REFINED if use.leans and self.full else use, fields)
        self.convergence = Convergence(system, self.options)
        self.rows, self.given = system.eqs.rows, system.eqs.given
        self.total = system.gather(system.state.d).copy()
        self.left = np.zeros_like(self.total)  # the residual that the last iteration left
        self.count = Counts()
        self.calm = 0  # steps since one that was hard
        self.steps = 0  # that were solved
        self.augments = any(g.physics.augments for g in system.groups) or any(a.augments for a in system.acting)
        self.before_augment: Callable[[], None] = lambda: None  # told of solutions whose multipliers are renewed next
        self.guess: Guess | None = None  # where steps begin to look, if they do not lean on the state before
        self.fields = [layout.equations(f, system.eqs.column) for f in layout.normed]
        if self.leans and system.bodies is None and system.rotations is None:
            self.guess = Guess(system.eqs.n, self.fields)
        self.fresh: Strategy = Loop(self)
        self.usual: Strategy = self.fresh
        if self.leans:
            self.usual, self.fresh = Kept(self, leans=True), Kept(self, leans=False)
        self.guarded: Strategy = Guarded(self)
        self.arc: Along | None = None
        self.only = False  # is no other strategy to be tried?

    @property
    def full(self) -> bool:
        """Is the tangent renewed in every iteration?"""
        return self.options.full

    @property
    def leans(self) -> bool:
        """Do steps lean on factorisations of earlier ones?"""
        return self.inverse.use.leans

    def follow(self, path: Along) -> None:
        """Solve all steps so."""
        self.arc = path
        self.take(path)

    def take(self, how: Strategy) -> None:
        """Solve all steps so, and in no other way."""
        self.usual = self.fresh = how
        self.only = True

    # ---- pieces -----------------------------------------------------------------------------------
    def on_rows(self, solve: Callable[[Floats], Floats], b: Floats) -> Floats:
        """Solve for the free unknowns; prescribed ones keep b."""
        x = b.copy()
        if len(self.rows):
            x[self.rows] = solve(b[self.rows])
        return x

    def tangent(self, step: Floats) -> tuple[Matrix, Floats]:
        """The tangent, and minus its prescribed columns times ``step``. Raises NotFinite."""
        with self.clock("tangent"):
            A, Fd = self.system.tangent(step)
        if not whole(A.data):
            raise blame(self.system, "tangent")
        return A, Fd

    def invert(self, A: Matrix, limited: bool = True) -> None:
        """Take A as the tangent whose inverse is applied; ``limited``: as often as FEBio's max_refs allows."""
        if limited and self.count.reforms >= self.options.max_reforms:
            raise NotConverged(f"the most stiffness reformations ({self.options.max_reforms}) were reached")
        dt = self.system.state.dt
        if A.n and not self.inverse.approach(A, dt):
            self.inverse.factorise(A, dt)
        self.count.reforms += 1

    def residual(self) -> Floats:
        """External minus internal forces over the equations. Raises NotFinite."""
        self.count.residuals += 1
        with self.clock("residual"):
            R = self.system.residual()
        if not self.system.finite:
            raise blame(self.system, "residual")
        return R

    def move(self, u: Floats, target: Floats | None = None) -> None:
        """Move the state to the increment so far and u, prescribed unknowns to their targets or to ``target``."""
        with self.clock("stress update"):
            self.system.set(self.total, self.increment, u, self.target if target is None else target)

    # ---- steps ------------------------------------------------------------------------------------
    def step(self, how: Strategy | None = None) -> Counts:
        """Solve the present time step. Raises NotConverged, NotFinite, ElementFailure or LinearError."""
        how = how or self.usual
        self.count = Counts()
        self.convergence.begin()
        made = self.inverse.made
        try:
            how.solve()
        finally:
            self.count.factorisations = self.inverse.made - made
        self.finish()
        self.calm = 0 if how.renewed or self.count.iterations > EASY else self.calm + 1
        return self.count

    def begin(self) -> Floats:
        """The present time step begins: contacts and stresses are updated. Increments of prescribed unknowns."""
        system = self.system
        self.aim()
        if self.options.logarithmic and self.steps:
            from .logarithmic import logarithmic

            system.join = logarithmic
        given = np.zeros_like(self.total)
        given[self.given] = (system.gather(self.target) - system.gather(system.state.d))[self.given]
        system.update()
        return given

    def aim(self) -> None:
        """Nothing has moved yet in the present time step, which prescribed unknowns are to end at their targets."""
        self.increment, self.target = np.zeros_like(self.total), self._targets()
        self.system.progress.iterations = self.system.progress.augmentations = 0

    def finish(self) -> None:
        """The increment is the step's. What contacts hold at ambient values keeps its own, from which it goes on where
        surfaces meet again (as in FEBio)."""
        self.total = self.system.accumulate(self.total, self.increment)
        self.steps += 1
        if self.guess is not None:
            self.guess.learn(self.system.state.dt, self.increment)

    def _targets(self) -> Floats:
        """Values (node, column) that prescribed unknowns take in the present step; NaN elsewhere."""
        out = self.system.targets(self.system.state.time)
        eqs = self.system.eqs
        if not whole(out.take(eqs.given_places)):
            row, column = (int(i) for i in np.argwhere(eqs.is_given & ~np.isfinite(out))[0])
            where = node(self.system.problem, row)
            raise NotFinite(f"the {self.system.layout.label(column)} prescribed on {where} is {out[row, column]:g}")
        return out

    def judge(self, u: Floats, s: float, R0: Floats, R1: Floats, updates: int) -> tuple[dict[str, Norm], bool]:
        """Take the step s u from residual R0 to R1; report its norms, and whether they are small enough."""
        k = self.count
        self.left = R1
        self.increment = self.system.compose(self.increment, s * u)
        self.system.settle()
        report, converged = self.convergence.test(u, s, R0, R1, self.increment)
        now = self.system.state.time
        self.watch(Iteration(now, k.iterations + 1, updates, k.residuals, k.reforms, s, report))
        return report, converged

    def augment(self) -> bool:
        """Renew all multipliers; have they converged? Where not, the system is updated with them."""
        k, system = self.count, self.system
        self.before_augment()
        done = [g.physics.augment(k.augmentations) for g in system.groups]
        done += [a.augment(k.augmentations, system.state) for a in system.acting]
        k.augmentations += 1
        system.progress.augmentations = k.augmentations
        k.reforms = 0
        if not all(done):
            system.update()
        return all(done)

    # ---- what a failed try gives back -------------------------------------------------------------
    def snapshot(self) -> Any:
        """The unknowns at the last converged state, the steps before it and the easy ones, the way along an arc, and
        what a guess is told from."""
        parts = (self.arc, self.guess)
        return self.total.copy(), self.calm, self.steps, *(None if p is None else p.snapshot() for p in parts)

    def restore(self, saved: Any) -> None:
        self.total, self.calm, self.steps = saved[0].copy(), saved[1], saved[2]
        for part, own in ((self.arc, saved[3]), (self.guess, saved[4])):
            if part is not None and own is not None:
                part.restore(own)

    def close(self) -> None:
        """Free all factorisations."""
        self.inverse.close()


__all__ = ["Counts", "Iteration", "LinearError", "Newton", "NotConverged", "Strategy"]
