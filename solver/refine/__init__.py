"""Meshes that are made finer between two solves of a time step: after each solved step elements that a criterion
selects are cut, and the step is solved once more on the new mesh from there. FEBio User Manual, "Mesh adaptor".

Nodal values are carried over as means of the corners that new nodes lie between; elements begin anew, at the
deformation that the nodes have, without what laws remembered (FEBio's ``map_data`` 0).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..criteria import Criterion, selected
from ..state import State
from .split import Hanging, Split
from .topology import Topology

if TYPE_CHECKING:
    from ..problem import Problem
    from ..system import System

Cut = Callable[..., "Split | None"]  # (topology, X, chosen, hanging, most) -> what becomes of the mesh


@dataclass(frozen=True, eq=False)
class Change:
    """A problem on a new mesh, and how it came of the old one."""

    problem: Problem
    split: Split

    @property
    def doubt(self) -> str:
        """What is to be warned of: where the answer is not FEBio's."""
        if not self.split.hanging or not self.problem.layout.mixed:
            return ""
        return ("nodes hang on larger elements, and hand fluid on to the corners there; FEBio 4.11 loses it, and so "
                "comes to another answer")  # fmt: skip

    def carry(self, old: State) -> State:
        """The state on the new mesh; new nodes begin without acceleration, as in FEBio."""
        s = State.at_rest(self.problem)
        s.d[:], s.velocity[:] = self.split.means(old.d), self.split.means(old.velocity)
        s.acceleration[: len(old.acceleration)] = old.acceleration
        s.time, s.dt = old.time, old.dt
        return s


@dataclass(eq=False)
class Refinement:
    """``cut``: how elements are cut; ``renew``: makes the problem anew on what they become. ``criterion``: which are
    chosen, with values above ``above`` (None: all), among ``elements`` by block (None: all). ``rounds``: most times in
    a step, ``limit``: none from so many elements on, ``most``: elements at a time (each 0 or less: any number).
    ``hanging``: nodes of the mesh that hang."""

    cut: Cut
    renew: Callable[[Split], Problem]
    criterion: Criterion | None = None
    above: float = 0.0
    rounds: int = -1
    limit: int = -1
    most: int = 0
    elements: dict[str, NDArray[np.int64]] | None = None
    hanging: Hanging | None = None

    def apply(self, done: int, system: System) -> Change | None:
        """The problem on a finer mesh after ``done`` rounds in the present step; None where nothing is cut."""
        groups = system.groups
        if 0 < self.rounds <= done or 0 < self.limit <= sum(g.m for g in groups):
            return None
        conn = np.concatenate([g.conn for g in groups]).astype(np.int64)
        ids = np.concatenate([g.block.ids for g in groups])
        top = Topology(groups[0].block.element, conn, ids, len(system.state.X))
        split = self.cut(top, system.state.X, self._chosen(system), self.hanging or {}, self.most)
        return None if split is None else Change(self.renew(split), split)

    def _chosen(self, system: System) -> NDArray[np.bool_]:
        """The elements to cut, of all groups one after another."""
        if self.criterion is None:
            return np.ones(sum(g.m for g in system.groups), bool)
        chosen, value = selected(self.criterion, self.elements, system)
        return np.asarray(chosen & (value > self.above))

    def begin(self) -> None:
        """A time step begins."""

    def give_back(self, system: System) -> None:
        """All is as it was before the step: the run goes back to the problem of then."""
