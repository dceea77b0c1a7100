"""The loop: analysis steps, time steps, retries; listeners are told of all of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from . import compilation
from .clock import Clock
from .elements import LINES
from .fields import DISPLACEMENT, Floats, Layout
from .finite import NotFinite, check_parameters, check_state
from .graph import Graph, MakeGraph
from .group import ElementFailure, Group, Impossible
from .guarded import Guarded
from .linear.base import LinearError, Stalled
from .newton import EASY, Counts, Iteration, Newton, NotConverged, Strategy
from .options import Options
from .problem import Block, NewtonOptions, Problem, Step
from .result import Result, Totals
from .route import Route
from .saving import wanted
from .schedule import Schedule, chunk_size
from .second_order import SecondOrder, refusal
from .state import State
from .step_state import StepState
from .stepping import AutoSteps, ErrorSteps, FixedSteps, stepper
from .system import System
from .threads import Team

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from .erosion import Erosion
    from .refine import Change, Refinement
    from .rigid.bodies import Bodies


class Listener:
    """Told what happens; override what matters. The solver itself writes nothing."""

    def compiling(self, run: Run, kernel: str) -> None: ...

    def warning(self, run: Run, message: str) -> None: ...

    def start(self, run: Run) -> None: ...

    def begin_analysis(self, run: Run) -> None: ...

    def begin_step(self, run: Run, number: int, time: float) -> None: ...

    def iteration(self, run: Run, it: Iteration) -> None: ...

    def converged(self, run: Run, counts: Counts) -> None: ...

    def failed(self, run: Run, reason: str, again: float | None) -> None: ...

    def remeshed(self, run: Run) -> None: ...  # the run has another problem and state from here on

    def save(self, run: Run, status: int) -> None: ...

    def stepped(self, run: Run) -> None: ...  # between two steps: what was to be saved is (:mod:`.checkpoint`)

    def end(self, run: Run, result: Result) -> None: ...


class Start(Protocol):
    """Where a run starts instead of at rest (:mod:`.checkpoint`): in which analysis step, at what time, after how many
    time steps; ``opened``: nodal values that the analysis step began with."""

    index: int
    time: float
    steps: int
    opened: dict[str, Any]

    def take_up(self, run: Run) -> str:
        """Bring a run there, whose analysis step is open; what is to be warned of. Raises Unfit."""


class Run:
    """One run of a problem: its state, groups and totals, for listeners to look at.

    graph: makes the sparsity of the tangent, or finds it where an earlier run left it (:class:`.graph.Graphs`).
    """

    def __init__(
        self, problem: Problem, listeners: Sequence[Listener] = (), options: Options | None = None,
        graph: MakeGraph = Graph,
    ) -> None:  # fmt: skip
        self._told: dict[str, list[Callable[..., object]]] = {}
        self.resumed: Start | None = None  # what the run goes on from
        self.remembers = False  # are checkpoints taken?
        self.problem, self.listeners, self.options = problem, list(listeners), options or Options()
        self._graph = graph
        self.team = Team(self.options.threads)
        self.state = State.at_rest(problem)
        self.groups: list[Group] = []
        self.clock = Clock()
        self.totals = Totals(seconds=self.clock.seconds)
        self.times: list[float] = []
        self.index = 0
        self.system: System | None = None
        self.bodies: Bodies | None = None
        self.stepper: FixedSteps | None = None
        self.integrator: SecondOrder | None = None
        self.count = 0  # time steps of the present analysis step
        self.saved_at = -1  # steps done as a state was saved last
        self.over = False  # were all steps solved?
        self.doubted = False  # was warned of meshes on which the answer is not FEBio's?
        self.opened: dict[str, Any] = {}  # nodal values that the present analysis step began with

    @property
    def step(self) -> Step:
        return self.problem.steps[self.index]

    def tell(self, event: str, *args: object) -> None:
        if event not in self._told:  # those that do something
            each, idle = [getattr(q, event) for q in self.listeners], getattr(Listener, event)
            self._told[event] = [hear for hear in each if getattr(hear, "__func__", None) is not idle]
        for hear in self._told[event]:
            hear(self, *args)

    # ---- the loop ---------------------------------------------------------------------------------
    @np.errstate(over="ignore", invalid="ignore", divide="ignore")  # what comes of it is found by ``finite``
    def solve(self) -> Result:
        """Run all steps. Failure and interruption end cleanly: what was saved stays. Raises checkpoint.Unfit."""
        t0, waited, made = compilation.now(), compilation.seconds(), compilation.count()
        compilation.hears.append(self.tell)
        reason, interrupted = "", False
        try:
            self._set_up()
            first = 0 if self.resumed is None else self.resumed.index
            for self.index in range(first, len(self.problem.steps)):  # noqa: B020
                reason = self._analysis()
                if reason:
                    break
            if not reason:
                self._save("solved")
                self.over = True
                self.tell("stepped")
        except KeyboardInterrupt:
            reason, interrupted = f"interrupted at time {self.state.time:g}", True
        except (ElementFailure, NotFinite) as e:
            reason = f"{e}, at time {self.state.time:g}"
        finally:
            compilation.hears.remove(self.tell)
        self.totals.seconds["total"] = compilation.now() - t0
        self.totals.compiled = compilation.count() - made
        if self.totals.compiled:
            self.totals.seconds["compiling"] = compilation.seconds() - waited
        result = Result(not reason, reason, self.state, self.totals, self.times, interrupted)
        self.tell("end", result)
        self.team.close()
        return result

    def _set_up(self) -> None:
        self._make_groups()
        if self.problem.bodies:
            if self.options.linear == "iterative":
                raise ValueError("multigrid knows nothing of the unknowns of rigid bodies: take another linear solver")
            from .rigid.bodies import Bodies

            self.bodies = Bodies(self.problem, self.state)
        self._initial(self.problem.common)
        if self.state.u.any():
            self._strain()
        self._begin(self.problem.common)
        self.tell("start")
        for message in filter(None, (g.folded() for g in self.groups)):
            self.tell("warning", message)
        if self.resumed is None and len(self.problem.steps) == 1:
            self._first_state()

    def _make_groups(self) -> None:
        size = chunk_size(sum(len(b.conn) for b in self.problem.blocks), self.team.n)
        self.groups = [_group(b, self.problem.X, size, self.state.layout) for b in self.problem.blocks]
        for g in self.groups:
            check_parameters(g.block, g.points(), steady=True)
        self.schedule = Schedule(self.groups, self.team)
        if self.options.stabilise:
            for g in self.groups:
                g.physics.stabilise(self.options.stabilise)

    def _initial(self, step: Step) -> None:
        s = self.state
        for c in step.initial:
            v = c.value(s.time, s.X[c.nodes], np.arange(len(c.nodes)))
            if c.velocity:
                s.velocity[c.nodes, c.column] = v
            else:
                s.d[c.nodes, c.column] = v
        if self.bodies is not None:
            self.bodies.start(s)
        for g in self.groups:
            g.physics.start(s)

    def _strain(self) -> None:
        """Elements take the state that initial displacements give them: rates are differences to it."""
        for g in self.groups:
            for c in g.chunks:
                g.update(c, self.state, self.state.u, [])
            if g.physics.collects:
                g.physics.collect(self.state)

    def _begin(self, step: Step) -> None:
        """What acts in a step begins to."""
        for a in [*step.loads, *step.body_loads, *step.contacts]:
            a.begin(self.state, self.groups)

    def _first_state(self) -> None:
        step = self.problem.steps[0]
        if step.saving.level == "PLOT_NEVER":
            return
        if step.auto is not None or step.saving.range[0] == 0 or step.saving.zero:
            for g in self.groups:
                if g.fields != (DISPLACEMENT.name,):
                    for c in g.chunks:
                        g.update(c, self.state, self.state.u, [])
            self._hand_over(0)

    def _analysis(self) -> str:
        """One analysis step; returns why it failed, or nothing."""
        reason = self._enter()
        if reason:
            return reason
        try:
            while self._unfinished:
                reason = self._time_step()
                if reason:
                    return reason
        finally:
            self.totals.factor = dict(self.newton.inverse.solver.stats)
            self.newton.close()
        loose = self.totals.factor.get("motions_without_stiffness", 0.0)
        if loose:
            self.tell("warning", f"{loose:g} motions have no stiffness; nothing loads them, so they stay as they are")
        self._save("step")
        if self.step is not self.problem.steps[-1]:
            self.tell("stepped")
        return ""

    def _enter(self) -> str:
        """Begin an analysis step; returns why it cannot, or nothing."""
        step, s = self.step, self.state
        resumed, self.resumed = self.resumed, None
        if resumed is None:
            self._initial(step)
            if self.index == 0 and len(self.problem.steps) > 1:
                self._first_state()
        else:
            s.restore(resumed.opened)
        if self.remembers:
            self.opened = s.snapshot()
        try:
            route = self._open()
        except LinearError as e:
            return str(e)
        assert self.system is not None
        self._begin(step)
        try:
            self.stepper = self._stepper()
        except ValueError as e:
            return str(e)
        self.integrator = self._second_order(self.newton)
        self.stepper.first(s.time)
        if self.stepper.vanishing:
            return f"the first time step is {self.stepper.dt:g}, at time {s.time:g}"
        self.count = 0
        if resumed is not None:
            why = resumed.take_up(self)
            if why:
                self.tell("warning", why)
        self.tell("begin_analysis")
        if self.system.dynamic and resumed is None:
            from .start import accelerate

            try:
                accelerate(self.system, route)
            except LinearError as e:
                return f"the accelerations at the start: {e}"
        return ""

    def _stepper(self) -> FixedSteps:
        """What sizes the time steps of the analysis step. Raises ValueError where there can be none."""
        return stepper(self.step, self.state.time, self.options.accuracy)

    def _open(self) -> Route:
        """The system of the analysis step and what solves it, for the elements that there are. Raises LinearError."""
        self.system = System(
            self.problem, self.step, self.groups, self.state, self.schedule, self.bodies, self._graph
        )
        route = Route(self.system, self.options, self.team.n)
        make, use = route.decide()
        watch = lambda it: self.tell("iteration", it)  # noqa: E731
        rest = make, watch, self.clock, use, self._newton_options()
        if self.step.explicit is None:
            self.newton = Newton(self.system, *rest)
            if self.step.newton.arc_length:
                from .arc_length import ArcLength

                self.newton.follow(ArcLength(self.newton))
            elif self.step.newton.descent:
                from .conjugate import ConjugateGradients

                self.newton.take(ConjugateGradients(self.newton))
        else:
            from .explicit import Explicit

            self.newton = Explicit(self.system, self.step.explicit, *rest)
        self.newton.inverse.remembers = self.remembers
        plain = self.newton.options.descent
        self.totals.linear_solver = f"none ({plain})" if plain else self.newton.inverse.solver.name
        return route

    def _newton_options(self) -> NewtonOptions:
        """Those of the file; increments are as small as asked for, and as the error of steps of their own size."""
        o = self.step.newton
        if self.options.quasi and o.full:
            o = replace(o, method="Broyden", updates=max(o.updates, NewtonOptions.updates))
        asked = [t for t in (self.options.accuracy, self.options.tolerance) if t]
        if not asked:
            return o
        most = min(asked)
        given = {f.option: o.tolerance(f) for f in self.state.layout.fields}
        return replace(o, tolerances={n: min(tol, most) if tol > 0 else tol for n, tol in given.items()})

    def _second_order(self, newton: Newton) -> SecondOrder | None:
        if not self.options.accuracy:
            return None
        why = refusal(self.problem)
        if why:
            raise ValueError(why)
        return SecondOrder(self.state, self.groups, newton, self.options.accuracy)

    def _time_step(self) -> str:
        s, step = self.state, self.stepper
        assert step is not None and self.system is not None
        before, whole = StepState([s, *self.groups, *self.system.acting, self.newton]), self._whole()
        how = self.newton.usual
        if self.integrator is not None:
            self.integrator.begin()
        while True:
            t = min(s.time + step.dt, step.end)
            s.dt, s.time = (t - s.time, t)
            if abs(step.end - t) < 1e-14 * abs(step.end):
                s.time = step.end
            self.tell("begin_step", self.count + 1, t)
            try:
                counts, good = self._attempt(how)
            except (NotConverged, NotFinite, ElementFailure, LinearError, np.linalg.LinAlgError) as e:
                counts, why = self.newton.count, str(e)
                self._add(counts)
                self.totals.lost += counts.iterations
                self._give_back(before, whole)
                newton = self.newton
                if how.stale or how.guessed:  # once more by itself, in all stages, before the step is cut
                    how = newton.fresh
                    continue
                other = None if _hopeless(e) else self._again(newton, how, e)
                said = "; again by guarded Newton steps" if other is newton.guarded else ""
                self.tell("failed", why + said, None if other is None else step.dt)
                if other is None:
                    return f"{why}, at time {t:g}{self._retried(e)}"
                how = other
                self.totals.retries += 1
                if newton.guess is not None:
                    newton.guess.doubt()
                continue
            self._add(counts)
            if not good:
                self._give_back(before, whole)
                self.totals.retries += 1
                self.totals.lost += counts.iterations
                again = None if step.vanishing else step.dt
                self.tell("failed", "the step's error is too large", again)
                if again is None:
                    return f"the error stays too large down to a step of {step.dt:g}, at time {s.time:g}"
                continue
            self.count += 1
            self.totals.steps += 1
            self.totals.guarded += isinstance(how, Guarded)
            self.tell("converged", counts)
            self._save("major")
            # more iterations with an old factorisation are no sign of a step that is too large
            s = self.state
            step.accept(s.time, min(counts.iterations, EASY) if how.stale else counts.iterations)
            if step.vanishing and step.end > s.time:
                return f"the time step has shrunk to {step.dt:g}, at time {s.time:g}"
            if self._unfinished:
                self.tell("stepped")
            return ""

    @property
    def _unfinished(self) -> bool:
        """Is the end of the analysis step ahead?"""
        step = self.stepper
        assert step is not None
        return step.end - self.state.time > abs(step.end) * 1e-7

    def _again(self, newton: Newton, how: Strategy, e: Exception) -> Strategy | None:
        """Make ready for another try at the present step, and say how it is solved; None where there is none.

        FEBio's way is a smaller step, until its retries are spent. Where elements turned inside out then, the step
        is tried by guarded Newton steps, as is every later one that fails, before it is halved.
        """
        step = self.stepper
        assert step is not None
        if step.beyond and not isinstance(how, Guarded):
            return newton.guarded
        if step.retry():
            return newton.guarded if isinstance(how, Guarded) else newton.fresh
        turned = isinstance(e, ElementFailure) and not newton.only
        return newton.guarded if turned and step.persist() else None

    def _retried(self, e: Exception) -> str:
        """What a final failure adds: the retries that were made."""
        step = self.stepper
        if _hopeless(e) or not isinstance(step, AutoSteps) or not step.retries:
            return ""
        how = "halvings by guarded Newton steps beyond the file's retries," if step.beyond else "retries"
        return f", after {step.retries} {how} down to a step of {step.dt:g}"

    def _attempt(self, how: Strategy) -> tuple[Counts, bool]:
        """Solve the step to the present time; was its error small enough?"""
        if self.integrator is None:
            self._prepare()
            return self._adapt(self.newton.step(how), isinstance(how, Guarded)), True
        s, dt = self.state, self.state.dt
        s.time -= dt
        counts, error = self.integrator.solve(dt, self._prepare, how)
        assert isinstance(self.stepper, ErrorSteps)
        return counts, self.stepper.judge(error)

    def _adapt(self, counts: Counts, guarded: bool) -> Counts:
        """Have adaptors change the mesh, and solve the step again from where it came, until they change no more.

        Returns the counts of the last solve, by which the next step is sized. ``guarded``: by guarded Newton steps, as
        it was solved.
        """
        done, system = 0, self.system
        assert system is not None
        for a in self._adaptors:
            a.begin()
        while any(changes := [a.apply(done, system) for a in self._adaptors]):
            done += 1
            for change in changes:
                if change and change is not True:
                    self._remesh(change)
            self._reopen()
            if not self.step.again:
                break
            assert self.system is not None
            system = self.system
            self._prepare()
            self._add(counts)
            counts = self.newton.step(self.newton.guarded if guarded else None)
        return counts

    @property
    def _adaptors(self) -> list[Erosion | Refinement]:
        return [*self.problem.common.adaptors, *self.step.adaptors]

    def _remesh(self, change: Change) -> None:
        """Go on with the problem on another mesh, whose elements begin at the deformation that the nodes have."""
        if change.doubt and not self.doubted:
            self.tell("warning", change.doubt)
        self.doubted = self.doubted or bool(change.doubt)
        self.problem, self.state = change.problem, change.carry(self.state)
        self._make_groups()
        for g in self.groups:
            g.physics.start(self.state)
        self._strain()
        for g in self.groups:
            g.set_history(g.old)  # laws remember nothing, as in FEBio, of the way there either
        self._begin(self.problem.common)
        self._begin(self.step)
        self.tell("remeshed")

    def _whole(self) -> tuple[Problem, State, list[Group]]:
        """What a change of the mesh replaces."""
        return self.problem, self.state, self.groups

    def _reopen(self) -> None:
        """Solve for the elements that there are now."""
        self.newton.close()
        self.schedule = Schedule(self.groups, self.team)
        self._open()

    def _give_back(self, before: StepState, whole: tuple[Problem, State, list[Group]]) -> None:
        """All is as it was before the step, the mesh too."""
        adaptors = self._adaptors
        for a in adaptors:
            assert self.system is not None
            a.give_back(self.system)
        remeshed = self.problem is not whole[0]
        self.problem, self.state, self.groups = whole
        before.restore()
        if adaptors:
            self._reopen()
        if remeshed:
            self.tell("remeshed")

    def _prepare(self) -> None:
        """The present state becomes the last converged one (FEBio's PrepStep)."""
        s, system = self.state, self.system
        assert system is not None
        s.d_old = s.d.copy()
        s.velocity_old, s.acceleration_old = s.velocity.copy(), s.acceleration.copy()
        if system.dynamic:
            s.acceleration = s.acceleration_old * (1 - 0.5 / system.beta) - s.velocity_old / (system.beta * s.dt)
            s.velocity = s.velocity_old + s.dt * (
                system.gamma * s.acceleration + (1 - system.gamma) * s.acceleration_old
            )
        for a in system.acting:
            a.begin_step(s)
        if self.bodies is not None:
            self.bodies.begin_step(s, system)
        if system.rotations is not None:
            system.rotations.begin_step(s, (system.beta, system.gamma) if system.dynamic else None)
        for g in self.groups:
            g.begin_step(s)

    def _add(self, c: Counts) -> None:
        t = self.totals
        t.iterations += c.iterations
        t.residuals += c.residuals
        t.reforms += c.factorisations

    # ---- saving -----------------------------------------------------------------------------------
    def _save(self, event: str) -> None:
        must = self.stepper is not None and self.stepper.at_must_point
        if wanted(self.step, event, self.count, must) and self.saved_at != self.totals.steps:
            self._hand_over(0 if event == "major" else 2)

    def _hand_over(self, status: int) -> None:
        check_state(self.problem, self.state, self.groups)
        self.saved_at = self.totals.steps
        self.times.append(self.state.time)
        with self.clock("output"):
            self.tell("save", status)


def _group(block: Block, X: Floats, chunk: int, layout: Layout) -> Group:
    """A block at work: solids, shells or lines."""
    if block.element in LINES:
        from .lines import Lines

        return Lines(block, X, chunk, layout)
    return Group(block, X, chunk, layout)


def _hopeless(e: Exception) -> bool:
    """Would a smaller step fail in the same way?"""
    singular = isinstance(e, LinearError) and not isinstance(e, Stalled)
    return singular or isinstance(e, Impossible) or (isinstance(e, NotFinite) and e.given)


def run(problem: Problem, listeners: Sequence[Listener] = (), options: Options | None = None) -> Result:
    """Solve a problem; listeners are told of iterations, steps and states to save."""
    return Run(problem, listeners, options).solve()
