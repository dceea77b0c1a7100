"""What a physics is: the fields that the elements of a block solve for, and their equations.

A :class:`Physics` is a record on a block. Opened over a group of elements it becomes :class:`Work`: arrays at the
integration points, and what makes residuals and tangents of them. The group (:mod:`..group`) has the geometry, the
kinematics (F and J, where the displacement is among the fields), the histories of the solid and the chunks.

A new physics is a file with one subclass of each, ending in ``register(Record, "name")``, and an entry in
``FILES`` of :mod:`..physics`. What its elements add to the tangent is given to :class:`..tangent.Target`: full
matrices (hi - lo, c n, c n), component-major, their c components those of ``group.columns``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..record import variable_record

if TYPE_CHECKING:
    from ..action import Ints, Matrices
    from ..changes import Changes
    from ..fields import Field
    from ..group import Chunk, Group
    from ..points import Points
    from ..state import State
    from ..tangent import Target, Workspace

Floats = NDArray[np.float64]
Output = Callable[[Any], "Floats | None"]


class Work:
    """Arrays of a group's elements and what is done with them. m elements, g integration points each.

    ``memory``: names of the arrays that a failed step gives back; ``held``: names of arrays at the points with what
    messages call them, which must be finite. ``outputs``: FEBio's names of plot variables with
    functions from the work to values at the integration points (m, g[, component]), None where it has none.
    ``collects``: stresses need all elements (:meth:`collect`). ``spins``: its inertia is its own, not that of the mass
    of displacements alone (:mod:`..mass`); ``pull``: sign of body loads on it.
    """

    memory: ClassVar[tuple[str, ...]] = ()
    held: ClassVar[Mapping[str, str]] = {}
    outputs: ClassVar[Mapping[str, Output]] = {}
    collects: ClassVar[bool] = False
    spins: ClassVar[bool] = False
    pull: ClassVar[float] = 1.0

    def __init__(self, group: Group, physics: Physics) -> None:
        self.group = group

    # ---- what is asked once -----------------------------------------------------------------------
    def symmetric(self, steady: bool) -> bool:
        """Is the tangent symmetric (``steady``: in steady-state analyses)?"""
        return True

    def swells(self) -> bool:
        """Does the mass of the elements grow with their volume?"""
        return False

    @property
    def recalls(self) -> bool:
        """Do steps begin from more than F, J and the solid's history?"""
        return True

    @property
    def augments(self) -> bool:
        """Are there multipliers that :meth:`augment` renews?"""
        return False

    def stabilise(self, tau: float) -> None:
        """Steady what needs it (:mod:`..kernels.projection`)."""

    # ---- residual and tangent ---------------------------------------------------------------------
    def update(self, c: Chunk, state: State, drive: list[Any]) -> None:
        """Stresses and fluxes of a chunk at the present state; ``drive``: body forces that act on fluids."""
        raise NotImplementedError

    def collect(self, state: State) -> None:
        """What is had from all elements, once all chunks are updated."""

    def end(self, state: State, alphaf: float) -> None:
        """What the state at the step's end adds where chunks were updated at a time within it (alphaf < 1)."""

    def residual(self, lo: int, hi: int, state: State, R: Floats, steady: bool) -> None:
        """Subtract internal forces of elements lo:hi from R (node, column)."""
        raise NotImplementedError

    def tangent(self, c: Chunk, state: State, target: Target, work: Workspace, steady: bool) -> None:
        """Add the tangents of a chunk's elements to ``target``."""
        raise NotImplementedError

    @property
    def varies(self) -> bool:
        """Can it say what small changes do (:meth:`vary`)?"""
        return False

    def vary(
        self, c: Chunk, state: State, changes: Changes, R: Floats, work: Workspace, steady: bool
    ) -> None:  # fmt: skip
        """Subtract what small changes of nodal values, laws and histories do to internal forces of a chunk's elements
        at the present state from R (v, node, the group's columns)."""
        raise NotImplementedError

    def cliques(self) -> list[Ints]:
        """Nodes (k, n) that are coupled beyond their elements."""
        return []

    def couplings(self, state: State, symmetric: bool) -> Matrices:
        """Tangents of such nodes, in triples as those of actions (:mod:`..action`)."""
        return []

    def inertia(self, state: State, R: Floats) -> None:
        """Subtract its own forces of inertia from R (node, column)."""

    def inertia_tangent(self, state: State, rule: tuple[float, float]) -> Matrices:
        """Minus their derivative by what the nodes do in the step, by Newmark's ``rule`` (beta, gamma); of t = 0, what
        takes accelerations to forces."""
        return []

    # ---- steps ------------------------------------------------------------------------------------
    def start(self, state: State) -> None:
        """Take what initial conditions gave the nodes, as an analysis step begins."""

    def begin_step(self, state: State) -> None:
        """The present state becomes the last converged one."""

    def settle(self) -> None:
        """The state after an iteration is the one that increments of the next start from."""

    def rates(self) -> list[tuple[Floats, Floats]]:
        """What rates are differences of: arrays (at the last converged state, now)."""
        return []

    def stages(self) -> None:
        """Steps are made of stages of backward Euler (:mod:`..second_order`), which all that has a rate follows."""

    def hidden(self) -> list[Floats]:
        """What has a rate of its own and is no nodal field: arrays at the points, whose error is watched like the
        fields'."""
        return []

    def augment(self, done: int) -> bool:
        """One augmentation of multipliers after ``done`` others; have they converged?"""
        return True

    def snapshot(self) -> dict[str, Floats]:
        """What a failed step must give back."""
        return {n: getattr(self, n).copy() for n in self.memory}

    def restore(self, saved: dict[str, Floats]) -> None:
        """Take back a snapshot."""
        for n in self.memory:
            getattr(self, n)[...] = saved[n]

    # ---- what others ask of the elements ----------------------------------------------------------
    def moduli(self, c: Chunk, s: Floats, C: Floats) -> None:
        """Add stress and tangent of the solid at a chunk's points to s (n, 6) and C (n, 6, 6)."""

    def tangents(self, pts: Points) -> list[tuple[str, Floats]]:
        """Tangents of the laws at points, with the names of what they are of, to say which is not finite."""
        return []

    def mass(self) -> tuple[Floats, Floats | None]:
        """Mass per reference volume (m, g), and the part of it that comes with volume, where there is one."""
        g = self.group
        return np.broadcast_to(g.block.solid.density(g.points()), g.m * g.g).reshape(g.m, g.g), None

    def permeability(self, pts: Points) -> Floats | None:
        """Permeability (n, 6) to fluid at points, None where there is no fluid."""
        return None

    def pressure(self, pts: Points) -> tuple[Floats, Floats] | None:
        """Actual fluid pressure p and J dp/dJ at fixed nodal values (n,), at all points; None where no fluid is."""
        return None

    def diffusivity(self, e: NDArray[np.int64], field: str) -> Floats | None:
        """phi kappa_hat D (n, 6) of the solute of a nodal field at the first points of elements e; None: none there."""
        return None

    def osmosis(self, e: NDArray[np.int64]) -> tuple[Floats, Floats, NDArray[np.int64]] | None:
        """Means over elements e: R T Phi (k,) and partition coefficients (k, m), and the columns of the m
        concentrations; None where nothing is dissolved."""
        return None

    def osmotic(self, e: NDArray[np.int64]) -> Floats | None:
        """Means over elements e of the osmotic part of the fluid pressure (k,); None where nothing is dissolved."""
        return None

    def carried(self, e: NDArray[np.int64], field: str) -> Floats:
        """Mean fluid flux over elements e times the mean actual concentration of the solute of a nodal field (k, 3)."""
        raise NotImplementedError

    def mixture_tangent(self, e: NDArray[np.int64], state: State) -> Floats | None:
        """Tangent (n, 6, 6) of a mixture with solutes at the first points of elements e; None where it is none."""
        return None


@variable_record
class Physics:
    """``rates``: its equations have rates besides those of inertia, which transient analyses integrate."""

    name: ClassVar[str] = ""
    rates: ClassVar[bool] = False
    work: ClassVar[type[Work]] = Work

    @property
    def fields(self) -> tuple[Field, ...]:
        """The nodal fields solved for; a group's ``columns`` follow their order."""
        raise NotImplementedError

    def open(self, group: Group) -> Work:
        """The physics at work over the elements of a group."""
        return self.work(group, self)
