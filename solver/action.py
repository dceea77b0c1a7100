"""What acts on the nodes beside the elements: loads, body loads, rigid connectors, contacts. One protocol for all.

A subclass overrides what matters to it; what it does not say is nothing. Forces are added to nodal arrays R (node,
column); the tangent is minus their derivative, in triples (K, nodes, columns): K (m, d, d), its row k being the unknown
in column ``columns[k]`` of node ``nodes[:, k]``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .group import Group
    from .state import State

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Matrices = list[tuple[Floats, Ints, Ints]]
NOWHERE = np.zeros(0, np.int64)


class Action:
    """``alpha``: weight of the step's end in forces taken within it; ``steady``: the analysis is a steady state. The
    system of an analysis step sets both. ``retraces``: where a step ends does not depend on how its iterations went, so
    that it can be differentiated (:mod:`.sensitivity`). ``touches``: a load that acts where
    nodes come to a surface, and ceases where they leave it, as contacts do.

    A load has ``residual(state, R)``; a body load has the groups it may act on besides, and a contact is updated
    (:mod:`.loads.body`, :mod:`.contact.base`).
    """

    alpha: float = 1.0
    steady: bool = False
    retraces: ClassVar[bool] = True
    touches: ClassVar[bool] = False

    @property
    def symmetric(self) -> bool:
        """Is its part of the tangent symmetric, or absent?"""
        return True

    @property
    def augments(self) -> bool:
        """Are there multipliers that :meth:`augment` renews?"""
        return False

    @property
    def joins(self) -> Ints:
        """Nodes whose displacements are unknowns for its sake."""
        return NOWHERE

    def cliques(self) -> list[Ints]:
        """Nodes (m, n) that its matrices couple, padded with -1."""
        return []

    def begin(self, state: State, groups: list[Group]) -> None:
        """It begins to act, in a new run or analysis step: nothing is left of an earlier run."""

    def begin_step(self, state: State) -> None:
        """A time step is about to be tried, from the last converged state to ``state.time``."""

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        """Minus the derivative of its forces."""
        return []

    def augment(self, done: int, state: State) -> bool:
        """One augmentation after ``done`` others; have the multipliers converged?"""
        return True

    def snapshot(self) -> Any:
        """What a failed step must give back."""
        return None

    def restore(self, saved: Any) -> None:
        """Take back a snapshot."""
