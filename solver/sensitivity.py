"""Derivatives of a run by parameters: the equations of each time step, differentiated.

For each parameter a variation of the run (:mod:`.variation`) has theta + delta in its place. After each step of the run
to U, where it leaves the residual R(U), the variations go to U' where R'(U') = R(U). x = (U' - U) / delta then solves

    K x = -(dR/dtheta + dR/dU_n x_n + dR/dh_n y_n) + O(delta),

y_n derivatives of histories h_n: all derivatives of R and of the laws' updates are differences along the directions
that are needed; what nodal values do to elements whose tangent is the derivative of their forces is had of that, for
all variations in one pass over the run's own elements (:mod:`.beside`). The factorisation that Newton's last iteration
leaves stands in for K^-1, for all parameters at once; multisecant corrections as in :class:`.quasi_newton.Anderson`, of
pairs that all parameters share, make good for what it is not. They end where the error that is expected of the last one
is small: by what one of its kind left in the last step that took two. Step sizes are the run's: they have no
derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import hypot
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .beside import Beside
from .finite import NotFinite, whole
from .forecast import Past
from .group import ElementFailure
from .kernels.vectors import add
from .linear.base import LinearError, LinearSolver
from .linear.pardiso import Pardiso
from .newton import Counts
from .problem import Problem
from .run import Listener, Run
from .step_state import StepState
from .variation import Variation
from .vectors import dot, norm

Floats = NDArray[np.float64]
STEP, BOTH = 1e-6, 1e-5  # delta over theta, where there is one variation for a parameter, and two
MOST = 25  # corrections in a step
PAIRS = 12  # the last ones are kept
SLOW = 0.005  # of an error that a correction may leave, though the last one left less
NOISE = 1e-14  # of positions and other unknowns, as large as they were: what is within it over delta counts as nothing
HIDDEN = 1e-12  # of them: changes within it are too rough to learn from
JUMP = 1e-4  # of them, in a variation: its parameter makes it jump
LOST = 1e-3  # relative error from which a derivative is given up
FAILURES = (ElementFailure, NotFinite, LinearError, ArithmeticError)


def refusal(problem: Problem) -> str:
    """Why the equations of a problem's steps are not differentiated; empty where they are."""
    steps = [problem.common, *problem.steps]
    if any(s.explicit for s in steps):
        return "the analysis is explicit"
    if any(s.adaptors for s in steps):
        return "the mesh changes"
    if any(s.newton.descent for s in steps):
        return "conjugate gradients leave no tangent"
    if any(s.newton.arc_length for s in steps):
        return "the loads follow an arc length"
    for a in (c for s in steps for c in s.contacts if not c.retraces):
        return f"contact by {type(a).__name__} depends on how iterations go"
    return ""


@dataclass(eq=False)
class _Search:
    """One variation's way to the run's residual: y, the correction that M^-1 makes of the difference, w the weights of
    its fields; u, the one taken; ``left``: relative sizes of y so far; ``rate``: what a correction leaves of them."""

    of: Variation
    rate: float
    left: list[float] = field(default_factory=list)
    y: Floats = field(default_factory=lambda: np.zeros(0))
    w: list[float] = field(default_factory=list)
    u: Floats = field(default_factory=lambda: np.zeros(0))

    def aim(self, y: Floats, w: list[float], e: float) -> None:
        """Take in a correction y of relative size e."""
        if self.left and self.left[-1] > 0.0:
            self.rate = e / self.left[-1]
        self.left.append(e)
        self.y, self.w = y, w

    def ended(self, tolerance: float) -> bool:
        """Is the error small enough once corrected, or as small as rounding lets it be?"""
        e = self.left[-1]
        stuck = e <= 0.1 * LOST and len(self.left) > 2 and e > 0.5 * self.left[-3]
        return stuck or e * min(max(self.rate, SLOW), 1.0) <= tolerance


class Sensitivities(Listener):
    """Follows a run by variations: for each parameter one or two problems with what it has more there (delta).

    tolerance: relative error of the derivatives of each nodal field, from step to step. Beyond it they have the error
    of one-sided differences, about delta, or of central ones, its square. ``runs`` are the variations of each
    parameter, as they stand; ``steps`` (end, is it a must point) the run's; ``passes`` counts residuals.
    """

    def __init__(self, varied: Sequence[Sequence[tuple[Problem, float]]], tolerance: float = 1e-3) -> None:
        self.varied, self.tolerance = list(varied), tolerance
        self.runs: list[list[Variation]] = []
        self.steps: list[list[tuple[float, bool]]] = []
        self.passes = 0
        self._before: list[StepState] = []

    # ---- events -----------------------------------------------------------------------------------
    def start(self, run: Run) -> None:
        if run.resumed is not None:
            raise ValueError("derivatives follow a run from its start: they cannot be had of one that goes on")
        self.steps = []
        self.runs = [[Variation(p, delta, run) for p, delta in some] for some in self.varied]
        for v in self.all:
            v._set_up()

    def begin_analysis(self, run: Run) -> None:
        self.steps.append([])
        assert run.system is not None
        self._beside = Beside(run)
        for v in self.live:
            v.enter()
            v.beside = self._beside.serves(v)
            v.rides = v.beside and v.light and not self._beside.loaded
        layout, column = run.system.layout, run.system.eqs.column[run.newton.rows]
        self._fields = [layout.equations(f, column) for f in layout.normed]
        self._sizes = np.zeros(len(self._fields))
        self._begun, self._made, self._far, self._past = False, -1, 0.0, Past()
        if self.varied and run.newton.augments:
            run.newton.before_augment = lambda: self._follow(run, augment=True)

    def begin_step(self, run: Run, number: int, time: float) -> None:
        if not run.newton.augments:
            return
        if self._begun:
            for before in self._before:
                before.restore()
        self._begun = False
        self._before = [StepState([v.state, *v.groups, *v.acting, v.newton]) for v in self.live]

    def converged(self, run: Run, counts: Counts) -> None:
        assert run.stepper is not None
        self.steps[-1].append((run.state.time, run.stepper.at_must_point))
        if not run.newton.augments:
            self._follow(run)
        self._past.add(run.state.dt, run.newton.increment[run.newton.rows])
        far = JUMP * self._far
        for v in self.live:
            v.end()
            if abs(v.delta) * norm(v.grown) > far:
                v.lost = f"the answer jumps with the parameter, at time {run.state.time:g}"
        self._begun = False

    # ---- what comes of it -------------------------------------------------------------------------
    @property
    def all(self) -> list[Variation]:
        return [v for some in self.runs for v in some]

    @property
    def live(self) -> list[Variation]:
        """The variations that still follow."""
        return [v for v in self.all if not v.lost]

    def lost(self, k: int) -> str:
        """Why there are no derivatives by parameter k, in a sentence."""
        return next((v.lost for v in self.runs[k] if v.lost), "")

    def ends(self, k: int, nodal: bool = False) -> tuple[Run, Run, float]:
        """Two runs that differ in parameter k alone, and by how much; brought up to date, ``nodal``: values and
        reactions of nodes at least."""
        v, *other = self.runs[k]
        late = [q for q in self.live if q.behind and not q.reacted] if nodal else []
        if late:
            self._beside.reactions(late)
        for q in (v, *other):
            if not (nodal and q.behind):
                q.show()
        return (v, other[0], v.delta - other[0].delta) if other else (v, v.base, v.delta)

    def of(self, k: int, value: Callable[[Run], Any]) -> Floats:
        """The derivative of a value of runs by parameter k."""
        high, low, delta = self.ends(k)
        return np.asarray((np.asarray(value(high)) - value(low)) / delta)

    # ---- a time step ------------------------------------------------------------------------------
    def _follow(self, run: Run, augment: bool = False) -> None:
        if not self.live:
            return
        with run.clock("sensitivities"):
            first = Variation.again if self._begun else self._beginner(run)
            self._begun = True
            self._match(run, first)
            if augment:
                _each(self.live, lambda v: v.newton.augment())

    def _beginner(self, run: Run) -> Callable[[Variation], None]:
        """What begins the step in a variation, told what the run has done in it beside what was foreseen."""
        grown = run.newton.increment[run.newton.rows]
        mean, bend = self._past.led(run.state.dt, len(grown))
        return lambda v: v.begin(grown - mean, bend)

    def _match(self, run: Run, first: Callable[[Variation], None]) -> None:
        """Bring the variations to the run's residual, each once ``first`` is done."""
        assert run.system is not None
        R, U, inverse = run.newton.left[run.newton.rows], _unknowns(run), run.newton.inverse
        fresh, self._made = inverse.made != self._made, inverse.made
        # the largest so far: where a pressure fades, the rounding that other fields bring into it does not
        self._sizes = np.maximum(self._sizes, [norm(U.take(own)) for own in self._fields])
        self._far = norm(U)
        pairs = _Pairs(U, self._fields)
        active = {v: _Search(v, v.usual if fresh else v.worn(inverse.made)) for v in self.live}
        for _ in range(MOST):
            found = self._differences(active, R, first)
            self.passes += len(found)
            active = {v: active[v] for v in found}
            for s, y in zip(active.values(), solve_all(inverse.solver, np.array(list(found.values())))):
                if s.left:
                    pairs.add(s.u, s.y - y, s.of.delta)
                s.aim(y, *self._weights(s.of, y))
                if len(s.left) == 2 and not fresh:
                    s.of.wears(inverse.made, s.rate)
            for s in active.values():
                s.u = pairs.corrected(s.y, s.w)
                s.of.correct(s.u)
                if s.ended(self.tolerance) and fresh:
                    s.of.usual = s.rate
            active = {v: s for v, s in active.items() if not s.ended(self.tolerance)}
            if not active:
                break
        for v, s in active.items():
            if s.left[-1] > LOST:
                v.lost = f"its equations are not solved to better than {s.left[-1]:.2g}, at time {v.state.time:g}"
        _each(self.live, Variation.stay)
        own = [v for v in self.live if v.beside and v.light]
        if own:
            self._beside.volumes(own)

    def _differences(
        self, active: dict[Variation, _Search], R: Floats, first: Callable[[Variation], None]
    ) -> dict[Variation, Any]:  # fmt: skip
        """Of residuals from R (row,), over what parameters differ by; at the first look once ``first`` is done."""
        begins = {v: None if s.left else first for v, s in active.items()}
        out = _each((v for v in active if not v.beside), lambda v: (v.look(begins[v]) - R) / v.delta)
        new = any(begins.values()) or self._beside.loaded
        some = _each((v for v in active if v.beside), (lambda v: v.place(begins[v])) if new else Variation.take)
        for v, r in self._passed(list(some), new).items():
            if whole(r):
                out[v] = r / v.delta
            else:
                v.lost = f"a force is not finite, at time {v.state.time:g}"
        return out

    def _passed(self, some: list[Variation], new: bool) -> dict[Variation, Floats]:
        """What is had beside the run; where a law fails, of each alone."""
        if not some:
            return {}
        if not new:
            return dict(zip(some, self._beside.next(some)))
        try:
            return dict(zip(some, self._beside.first(some)))
        except FAILURES:
            return _each(some, lambda v: self._beside.first([v])[0])

    def _weights(self, v: Variation, y: Floats) -> tuple[list[float], float]:
        """Of each field, what makes the norm of a correction relative; that of y."""
        x, least = v.grown + v.x + y, NOISE / self.tolerance / abs(v.delta)
        sizes = [max(norm(x.take(own)), least * whole) for own, whole in zip(self._fields, self._sizes)]
        w = [1.0 / size if size > 0.0 else 0.0 for size in sizes]
        return w, hypot(*(c * norm(y.take(own)) for c, own in zip(w, self._fields)))


class _Pairs:
    """Corrections d and what they change, M^-1 (R - R1) = Z: an inverse that is better than M^-1. Both are kept as the
    variations hold them, times delta: so rounding is the same in all. Norms are weighted field by field."""

    def __init__(self, U: Floats, fields: list[NDArray[np.int64]]) -> None:
        self._fields, self._count = fields, 0
        self._sizes = [norm(U.take(own)) for own in fields]
        self._more: list[Floats] = []  # d - Z
        self._Z: list[list[Floats]] = []  # of each field
        self._products = np.zeros((len(fields), PAIRS, PAIRS))  # Z Z^T

    def add(self, d: Floats, Z: Floats, delta: float) -> None:
        k = self._count % PAIRS
        self._more[k:] = [delta * (d - Z), *self._more[k + 1 :]]
        self._Z[k:] = [[delta * Z.take(own) for own in self._fields], *self._Z[k + 1 :]]
        self._count += 1
        for products, new, *others in zip(self._products, self._Z[k], *self._Z):
            products[k, : len(others)] = products[: len(others), k] = [dot(new, z) for z in others]

    def corrected(self, y: Floats, w: list[float]) -> Floats:
        """y + sum g_i (d_i - Z_i), g the least-squares solution of w Z g = w y but for what rounding hides."""
        k, parts = len(self._Z), [y.take(own) for own in self._fields]
        if not k:
            return y
        hidden = HIDDEN**2 * sum((c * size) ** 2 for c, size in zip(w, self._sizes))
        square, V = np.linalg.eigh(sum(c * c * G[:k, :k] for c, G in zip(w, self._products)))
        b = V.T @ [sum(c * c * dot(z, q) for c, z, q in zip(w, Z, parts)) for Z in self._Z]
        sound = square > max(hidden, 1e-13 * square[-1])
        g = V[:, sound] @ (b[sound] / square[sound])
        out = y.copy()
        for c, more in zip(g, self._more):
            add(c, more, out)
        return out


def _unknowns(run: Run) -> Floats:
    """Positions and other unknowns (row,), whose rounding forces have."""
    assert run.system is not None
    d = run.state.d.copy()
    if run.state.layout.moves:
        run.state.layout.u(d)[:] += run.state.X
    return np.asarray(run.system.gather(d)[run.newton.rows])


def _each(runs: Any, do: Callable[[Variation], Any]) -> dict[Variation, Any]:
    """Do something to each; those are lost where it fails."""
    out = {}
    for v in runs:
        try:
            out[v] = do(v)
        except FAILURES as e:
            v.lost = f"{e}, at time {v.state.time:g}"
    return out


def solve_all(solver: LinearSolver, B: Floats) -> Floats:
    """Solutions (k, row) of right sides (k, row)."""
    if not B.size:
        return B
    return solver.solve(B) if isinstance(solver, Pardiso) else np.array([solver.solve(b) for b in B])
