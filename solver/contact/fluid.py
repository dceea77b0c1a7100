"""What biphasic contacts share: which facets are porous, pressures on both sides, and the flow between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..fields import PRESSURE
from ..kernels import contact_flow as kernels
from .base import Side
from .surface import Floats, Ints, Surface

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


def porous(surface: Surface, groups: list[Group], field: str = PRESSURE.name) -> NDArray[np.bool_]:
    """Does the element behind each facet (f,) hold fluid, or the solute of another ``field``?"""
    out = np.zeros(len(surface.conn), bool)
    wet = np.array([field in g.fields for g in groups] + [False])
    for kind, rows in surface.kinds:
        if kind in surface.given.owner:
            out[rows] = wet[surface.given.owner[kind][:, 0]]
    return out


def pressures(s: Side, state: State, field: str = PRESSURE.name) -> tuple[Floats, Floats]:
    """Fluid pressures, or another scalar field (q,), at the points and at their partners."""
    p = state.layout.scalar(state.d, field)
    own = (s.N * p[np.maximum(s.conn, 0)][s.facet]).sum(axis=1)
    other = (s.M * p[np.maximum(s.other.conn, 0)][s.partner]).sum(axis=1)
    return own, np.where(s.partner >= 0, other, 0.0)


def both(s: Side, here: NDArray[np.bool_], there: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Points (q,) where both facets are porous."""
    return here[s.facet] & there[s.partner] & (s.partner >= 0)


def spread(state: State, s: Side, f: Floats, R: Floats, field: str = PRESSURE.name) -> None:
    """Add f (q,) to the rows of the pressures or of another field, primary nodes gaining what secondary ones lose."""
    o, Rp = s.other, state.layout.scalar(R, field)
    kernels.spread(s.conn, s.count, s.facet, s.N, o.conn, o.count, s.partner, s.M, f, Rp)


def unknowns(state: State, nodes: Ints, field: str = PRESSURE.name) -> tuple[Floats, Ints, Ints]:
    """Zero matrices over the displacements of ``nodes`` (m, n), node by node, and then their pressures (``field``)."""
    m, n = nodes.shape
    columns = np.concatenate([np.tile(state.layout.displacement, n), np.repeat(state.layout.columns(field), n)])
    return np.zeros((m, 4 * n, 4 * n)), np.hstack([np.repeat(nodes, 3, axis=1), nodes]), columns
