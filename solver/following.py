"""Boundary conditions whose values follow the solution: fluid pressures that depend on what is dissolved.

Within a step they go by the concentrations of the last iterate and the partition coefficients at it, as in FEBio:
they are no unknowns, and the tangent does not know them.
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .loads.base import Patch, scalar
from .problem import Prescribed
from .record import variable_record
from .values import as_value

if TYPE_CHECKING:
    from .group import Group
    from .state import State

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@variable_record
class Following(Prescribed):
    """``surface``: facets, each patch with the block and element (f, 2) behind its facets.

    The value at a node is the mean over the facets around it of what :meth:`at_corners` gives. ``last`` (n,): what it
    was when last asked for, and stays until a step's first iterate; as in FEBio, a step that failed leaves its own.
    """

    follows: ClassVar[bool] = True
    surface: tuple[tuple[Patch, Ints], ...] = field(default=(), kw_only=True)
    last: Floats | None = field(default=None, init=False, repr=False)

    def begin(self, groups: list[Group]) -> None:
        self._groups, self.last = groups, None

    def values(self, state: State) -> Floats:
        """Values at ``nodes`` at the present iterate."""
        total, count = np.zeros(len(state.d)), np.zeros(len(state.d))
        for patch, owner in self.surface:
            for block in np.unique(owner[:, 0]):
                rows = np.flatnonzero(owner[:, 0] == block)
                conn = patch.conn[rows]
                v = self.at_corners(state, patch, rows, self._groups[int(block)], owner[rows, 1])
                np.add.at(total, conn, np.broadcast_to(v, conn.shape))
                np.add.at(count, conn, 1.0)
        self.last = np.asarray(total[self.nodes] / count[self.nodes])
        return self.last

    def at_corners(self, state: State, patch: Patch, rows: Ints, group: Group, elements: Ints) -> Floats:
        """Values (f, n|1) at the corners of the facets ``rows``, behind which are ``elements`` of a group."""
        raise NotImplementedError


def _means(value: Any, state: State, patch: Patch, rows: Ints) -> Floats:
    """Means of a value over facets (f, 1)."""
    v = np.broadcast_to(scalar(value, state.time, patch), (patch.element.npoints * len(patch.conn),))
    return np.asarray(v.reshape(len(patch.conn), -1)[rows].mean(axis=1)[:, None])


@variable_record
class ActualPressure(Following):
    """Effective pressure p~ = p - R T Phi sum_i kappa_i c_i for an actual pressure p.

    c at the nodes; Phi and kappa means over the element behind a facet. FEBio User Manual, "Actual Fluid Pressure".
    """

    def at_corners(self, state: State, patch: Patch, rows: Ints, group: Group, elements: Ints) -> Floats:
        p = _means(self.value, state, patch, rows)
        osmosis = group.physics.osmosis(elements)
        if osmosis is None:
            return p
        RTphi, kappa, columns = osmosis
        c = state.d[:, columns][patch.conn[rows]]
        return np.asarray(p - RTphi[:, None] * np.einsum("fnm,fm->fn", c, kappa))


@variable_record
class ElementPressure(Following):
    """As :class:`ActualPressure`, all that is osmotic being a mean over the element. FEBio's load "fluid pressure".

    FEBio 4.11 takes the whole parts of R and T there; ``share`` is their product over R T.
    """

    share: float = field(default=1.0, kw_only=True)

    def at_corners(self, state: State, patch: Patch, rows: Ints, group: Group, elements: Ints) -> Floats:
        p, osmotic = _means(self.value, state, patch, rows), group.physics.osmotic(elements)
        return p if osmotic is None else np.asarray(p - self.share * osmotic[:, None])


@variable_record
class MatchingOsmotic(Following):
    """Effective pressure p~ = p - R T Phi o of a bath of pressure p and osmolarity o, Phi that of the tissue.

    FEBio User Manual, "Matching Osmotic Coefficient".
    """

    osmolarity: Any = 0.0  # a Value

    def __post_init__(self) -> None:
        self.osmolarity = as_value(self.osmolarity)

    def at_corners(self, state: State, patch: Patch, rows: Ints, group: Group, elements: Ints) -> Floats:
        p = _means(self.value, state, patch, rows)
        osmosis = group.physics.osmosis(elements)
        return p if osmosis is None else p - osmosis[0][:, None] * _means(self.osmolarity, state, patch, rows)
