"""Which linear solver an analysis gets, and what is made of its factorisations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from .inverse import FRESH, LEANING, REFINED, Use
from .linear.base import Direct, LinearError, LinearSolver
from .linear.choose import choose
from .problem import TRANSIENT

if TYPE_CHECKING:
    from .options import Options
    from .system import System

REUSE_EQUATIONS = 3000  # below, factorisations are too cheap to save
POROUS_EQUATIONS = 10_000  # the same of mixtures whose iterations are to stay FEBio's: rounding may decide a hard step
CONTACT_EQUATIONS = 20_000  # the same with contact: on coarse surfaces rounding may decide which facet a node meets
LARGE = 50_000  # equations from which a factorisation might not fit in memory


class Route:
    """The choices of one analysis step; see :class:`.options.Options`."""

    def __init__(self, system: System, options: Options, threads: int) -> None:
        self.system, self.options, self.threads = system, options, threads
        self.rows = len(system.eqs.rows)

    def decide(self) -> tuple[Callable[[], LinearSolver], Use]:
        """What makes linear solvers, and the use of factorisations; "auto" tries whether one fits in memory.

        Raises LinearError where none does and the iterative solver cannot stand in.
        """
        name, use = self.options.linear, self.use()
        first = self.solver(name, use.single)
        tried = self.rows >= LARGE or self.options.memory > 0.0
        if name == "auto" and tried and isinstance(first, Direct):
            left, need = self._room(), first.memory(self.system.matrix)
            if need > left:
                first.close()
                name, use, first = "iterative", FRESH, self._in_its_place(need, left)
            elif 2.0 * need > left:
                use = replace(use, doubles=False)
        spare = [first]
        return lambda: spare.pop() if spare else self.solver(name, use.single), use

    def solver(self, name: str, single: bool = False) -> LinearSolver:
        """A solver for the system; ``single``: its factor may be of single precision."""
        known = None
        if name == "iterative":
            from .storage import unknowns

            known = unknowns(self.system)
        return choose(name, self.rows, self.threads, single, known, self.system.mixed, bool(self.system.contacts))

    def use(self) -> Use:
        """What is made of factorisations."""
        o, system = self.options, self.system
        if o.linear == "iterative" or o.factor == "fresh":
            return FRESH  # where there is one at all
        if o.factor == "reuse":
            return LEANING
        touches = bool(system.contacts) or any(load.touches for load in system.loads)
        if self.rows < (CONTACT_EQUATIONS if touches else REUSE_EQUATIONS):
            return FRESH
        step = system.step
        pinned = step.auto is not None or o.accuracy > 0.0
        pinned = pinned and step.saving.level != "PLOT_MAJOR_ITRS"
        transient = system.problem.diffuses and step.analysis == TRANSIENT
        if pinned and transient and not system.contacts:
            return LEANING
        if system.problem.diffuses and self.rows < POROUS_EQUATIONS:
            return FRESH
        thin = any(g.shell for g in system.groups)  # whose bending single precision does not resolve
        return replace(REFINED, single=not thin)

    def _room(self) -> float:
        """Bytes that a factorisation may take."""
        if self.options.memory:
            return self.options.memory * 1e9
        from .linear.memory import SHARE, available

        return SHARE * available()

    def _in_its_place(self, need: float, left: float) -> LinearSolver:
        """The iterative solver, where it can be had."""
        said = f"a factorisation takes {need / 1e9:.1f} GB of memory and {left / 1e9:.1f} GB are left"
        if self.system.bodies is not None:
            raise LinearError(f"{said}; the iterative solver does not take rigid bodies")
        try:
            return self.solver("iterative")
        except LinearError as e:
            raise LinearError(f"{said}; without it {e}; --linear pardiso tries all the same") from None
