"""A run beside another one, of the same problem with a parameter that differs a little: its steps are the other's."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .alike import alike
from .forecast import Forecast
from .group import Group
from .kernels.vectors import put_difference, put_sum
from .newton import Counts, Newton
from .problem import Problem
from .route import Route
from .run import Run
from .step_state import Part
from .system import System

Floats = NDArray[np.float64]
ALIKE = 1.25  # step sizes within this factor: an old factorisation does for one what it did for the other,
CAREFUL = 2.0  # or leaves so many times as much


class Variation(Run):
    """``problem``: that of the run ``base`` with a parameter ``delta`` larger.

    It takes the steps that the base has taken, from a state and histories of its own, and factorises nothing. x (row,)
    are derivatives of what the free unknowns grow by in the present step, ``grown`` of what they grew by before it in
    the present analysis step. ``lost``: why it does not go on, in a sentence; ``usual``: what a correction by a
    factorisation of the step's own leaves of an error.

    Where its elements' forces are had beside the base's (``beside``: :mod:`.beside`), its own elements follow at the
    end of a step, or once they are asked for. Group by group, ``differs``: are stresses and other laws not the base's;
    ``swelled``: by how much relative volumes (m, g) differ from the base's as the step begins, ``swells``: as it ends;
    ``inner``: by how much forces of all elements (node, column) do; ``reacted``: reactions are those of the step's end.
    Where nothing acts beside the elements it ``rides`` on the base: D (node, column) is all that it keeps of its nodal
    values, by how much they differ from the base's, until these are asked for.
    """

    def __init__(self, problem: Problem, delta: float, base: Run) -> None:
        super().__init__(problem, (), base.options)
        self.base, self.delta, self.team = base, delta, base.team
        self.lost, self.usual = "", 1.0
        self._waits: tuple[Floats, ...] = ()  # how to place the state where the last step ended
        self.beside = self.rides = self.reacted = False
        self._late = False  # do nodal values that ride wait to be asked for?
        self.x = self.u = np.zeros(0)
        self.D = self.D_old = np.zeros_like(self.state.d)
        self.inner = np.zeros_like(self.state.d)

    def _set_up(self) -> None:
        super()._set_up()
        for g, of_base in zip(self.groups, self.base.groups):  # one copy of what is the same stays in the cache
            if np.array_equal(g.iJ0, of_base.iJ0) and np.array_equal(g.conn, of_base.conn):
                g.iJ0, g.wJ0, g.conn = of_base.iJ0, of_base.wJ0, of_base.conn

    # ---- analysis steps ---------------------------------------------------------------------------
    def _open(self) -> Route:
        self.system = System(self.problem, self.step, self.groups, self.state, self.schedule, self.bodies)
        spare = self.base.newton.inverse.solver
        self.newton = Newton(self.system, lambda: spare, lambda it: None, self.clock, options=self._newton_options())
        return Route(self.system, self.options, self.team.n)

    def enter(self) -> None:
        """Begin the analysis step that the base has begun."""
        self._renew()
        self.index = self.base.index
        self.lost = self._enter()
        if self.lost:
            return
        assert self.system is not None
        if not np.array_equal(self.newton.rows, self.base.newton.rows):
            self.lost = "the unknowns of the model change with it"
        self.grown = np.zeros(len(self.newton.rows))
        layout, column = self.system.layout, self.system.eqs.column[self.newton.rows]
        fields = [layout.equations(f, column) for f in layout.normed]
        self._forecast = Forecast(fields, len(self.grown), learns=self.base.newton.leans)  # else it would not pay
        self._worn: list[tuple[int, float, float]] = []
        remembers = any(g.physics.recalls or g.new.shape[1] for g in self.groups)
        turns = self.bodies is not None or self.system.rotations is not None
        self.light = not (remembers or turns or self.system.contacts or self.system.following)
        pairs = list(zip(self.groups, self.base.groups))
        self.differs = [_differs(a, b) for a, b in pairs]
        self.swells = [a.J - b.J for a, b in pairs]
        self.D = self.state.d - self.base.state.d

    @property
    def acting(self) -> list[Part]:
        return [] if self.system is None else [*self.system.acting]

    # ---- time steps -------------------------------------------------------------------------------
    def begin(self, beside: Floats, bend: Floats) -> None:
        """Begin the time step that the base has taken; the first place to look is where :mod:`.forecast` has it."""
        system, n, base = self.system, self.newton, self.base
        assert system is not None and base.system is not None
        if self.rides:
            return self._board(beside, bend)
        if self._waits and not self.beside:
            system.place(*self._waits)
            for g in (g for g in self.groups if g.deforms):
                g.deform(self.state.u, g.F, g.J)
        self._waits = ()
        self.state.time, self.state.dt = base.state.time, base.state.dt
        self._prepare()
        n.count = Counts()
        n.aim()
        self.swelled, self.swells = self._swelled(), list(self.swells)
        if system.contacts:
            system.update()
            for own, led in zip(system.contacts, base.system.contacts):
                own.restore(_led(own.snapshot(), led.snapshot()))
        system.progress.iterations = base.system.progress.iterations
        self._head(self._forecast(self.state.dt, beside, bend))

    def _board(self, beside: Floats, bend: Floats) -> None:
        """Begin a step that rides on the base's."""
        s, of_base, eqs = self.state, self.base.state, self.newton.system.eqs
        s.time, s.dt, self._late = of_base.time, of_base.dt, False
        self.newton.aim()
        self.swelled, self.swells = self.swells, list(self.swells)
        self.D_old, self.D = self.D, self.D.copy()
        given = self.newton.target.reshape(-1), of_base.d.reshape(-1)
        put_difference(eqs.given_places, *given, self.D.reshape(-1))
        self.x = self._forecast(s.dt, beside, bend).copy()

    def again(self) -> None:
        """The base has gone on within the step, with new multipliers: look where it is now."""
        assert self.system is not None and self.base.system is not None
        self.newton.increment = np.zeros_like(self.newton.total)
        self.system.progress.iterations = self.base.system.progress.iterations
        self._head(self.x)

    def worn(self, made: int) -> float:
        """What a correction by an old factorisation, one of ``made``, may leave of an error in the present step."""
        own = self.state.dt
        for key, dt, rate in reversed(self._worn):
            if key == made and max(dt, own) <= ALIKE * min(dt, own):
                return min(1.0, CAREFUL * rate)
        return 1.0

    def wears(self, made: int, rate: float) -> None:
        """It has left ``rate`` of one."""
        self._worn = [*self._worn[-3:], (made, self.state.dt, rate)]  # steps alternate between long ones and short ones

    def _head(self, x: Floats) -> None:
        self.x, self.ahead = x.copy(), self.base.newton.increment.copy()
        put_sum(self.newton.rows, self.ahead, self.delta, x, self.ahead)

    def correct(self, u: Floats) -> None:
        """Add u (row,) to x."""
        self.x += u
        self.u = u
        if self.rides:
            return
        self.ahead = np.zeros_like(self.newton.total)
        put_sum(self.newton.rows, self.ahead, self.delta, u, self.ahead)

    def look(self, first: Callable[[Variation], None] | None = None) -> Floats:
        """Move as corrected, once ``first`` is done, whose arrays are in the cache then; the residual (row,)."""
        if first is not None:
            first(self)
        self.newton.move(self.ahead)
        self.take()
        return self.newton.residual().take(self.newton.rows)

    def place(self, first: Callable[[Variation], None] | None = None) -> None:
        """Move nodal values as corrected, once ``first`` is done; elements stay as they are."""
        if first is not None:
            first(self)
        self._place()
        self.take()

    def stay(self) -> None:
        """Move as corrected, for good: once it is asked for, where steps begin from no more than a deformation."""
        n, self.reacted, self._late = self.newton, False, self.rides
        if self.rides:
            return self._place()
        if not self.light:
            n.move(self.ahead)
        elif self.beside:
            self._place()
        if self.light:
            self._waits = n.total, n.increment, self.ahead, n.target
        self.take()
        if not self.beside:  # rotations are composed
            self.x = (n.increment - self.base.newton.increment).take(n.rows) / self.delta

    def _place(self) -> None:
        n = self.newton
        if self.rides:
            free, before, now = n.system.eqs.free_places, self.D_old.reshape(-1), self.D.reshape(-1)
            return put_sum(free, before, self.delta, self.x, now)
        n.system.place(n.total, n.increment, self.ahead, n.target)

    def take(self) -> None:
        """The correction is part of what the step has grown by."""
        n = self.newton
        if not self.rides:
            n.increment = n.system.compose(n.increment, self.ahead)
            n.system.settle()

    def end(self) -> None:
        """The time step ends."""
        self._forecast.learn(self.state.dt, self.x)
        self.grown = self.grown + self.x
        if not self.rides:
            self.newton.finish()

    def show(self) -> None:
        """Bring all up to date with the end of the last step, stresses and reactions too."""
        self._renew()
        if self.system is not None:  # an analysis step has begun
            self.system.residual()

    @property
    def behind(self) -> bool:
        """Do elements stand where an earlier step ended, though nodal values may serve as they are?"""
        return self._late or (self.beside and bool(self._waits))

    def alight(self) -> None:
        """Nodal values that ride on the base's take their places."""
        s, of_base = self.state, self.base.state
        if self._late:
            s.d, s.d_old = of_base.d + self.D, of_base.d_old + self.D_old
            self.newton.system.set_rates()

    def _renew(self) -> None:
        """Bring elements up to date with the end of the last step."""
        if not (self._late or self._waits):
            return
        assert self.system is not None
        if self.beside:
            for g, b, more in zip(self.groups, self.base.groups, self.swelled):
                for (own, _), (of_base, _) in zip(g.physics.rates(), b.physics.rates()):
                    own[...] = of_base + more
        if self._late:
            self.alight()
            self.system.update()
        else:
            self.system.set(*self._waits)
        self._waits, self._late = (), False

    def _swelled(self) -> list[Floats]:
        """By how much relative volumes (m, g) differ from the base's where the present step began."""
        if self.light:
            return self.swells
        out = []
        for g, b in zip(self.groups, self.base.groups):
            rates = zip(g.physics.rates(), b.physics.rates())
            out.append(next((own - of_base for (own, _), (of_base, _) in rates), np.zeros_like(g.J)))
        return out


def _differs(a: Group, b: Group) -> tuple[bool, bool]:
    """Are stresses of two groups, and what else their physics has, others at the same nodal values?"""
    axes = not alike(a.block.axes, b.block.axes)
    stress = axes or bool(a.new.shape[1]) or not alike(a.block.solid, b.block.solid)
    return stress, axes or not alike(a.block.physics, b.block.physics)


def _led(own: Any, other: Any, name: str = "") -> Any:
    """A contact's snapshot with what ``other``'s has of partners, places on these and other choices."""
    if isinstance(own, dict):
        return {k: _led(v, other[k], k) for k, v in own.items()}
    if isinstance(own, (list, tuple)):
        return type(own)(_led(a, b) for a, b in zip(own, other))
    chosen = name == "rs" or np.asarray(own).dtype.kind in "iub"
    return other if chosen else own
