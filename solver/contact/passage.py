"""What passes between surfaces in contact: the fluid, or a solute, as a flow between integration points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..fields import DISPLACEMENT, PRESSURE
from ..kernels import contact_flow as kernels
from .surface import Floats, Ints, Surface

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ..group import Group
    from ..state import State
    from .base import Side

Bools = NDArray[np.bool_]


def holds(surface: Surface, groups: list[Group], field: str) -> Bools:
    """Does the element behind each facet (f,) have ``field`` among its own?"""
    out = np.zeros(len(surface.conn), bool)
    has = np.array([field in g.fields for g in groups] + [False])
    for kind, rows in surface.kinds:
        if kind in surface.given.owner:
            out[rows] = has[surface.given.owner[kind][:, 0]]
    return out


class Passage:
    """A flow L + eps (p1 - p2) per area from the points (q,) of a side to their partners, p a field of one component.

    ``own`` and ``beyond`` tell which facets of the side and of the other surface hold it. At the points: ``step`` the
    difference p1 - p2, ``multiplier`` L, ``conductance`` what ``penalty`` multiplies to eps.
    """

    memory = ("step", "multiplier", "conductance")

    def __init__(self, field: str, penalty: float, own: Bools, beyond: Bools, conductance: Floats) -> None:
        self.field, self.penalty, self.own, self.beyond = field, penalty, own, beyond
        self.conductance = conductance
        self.step, self.multiplier = np.zeros(len(conductance)), np.zeros(len(conductance))

    def open(self, s: Side) -> Bools:
        """Points whose facets hold the field on both sides."""
        return self.own[s.facet] & self.beyond[s.partner] & (s.partner >= 0)

    def values(self, s: Side, state: State) -> tuple[Floats, Floats]:
        """p1 and p2 (q,) at the present state."""
        p = state.layout.scalar(state.d, self.field)
        here = (s.N * p[np.maximum(s.conn, 0)][s.facet]).sum(axis=1)
        return here, (s.M * p[np.maximum(s.other.conn, 0)][s.partner]).sum(axis=1)

    def update(self, s: Side, state: State) -> None:
        """Take the differences at the present state."""
        here, there = self.values(s, state)
        self.step = np.where(self.open(s), here - there, 0.0)

    def flow(self, s: Side, bears: Bools | None = None) -> tuple[Floats, Floats]:
        """wn and eps (q,), zero where nothing passes, and where ``bears`` says that there is no contact."""
        passes = self.open(s) if bears is None else self.open(s) & bears
        eps = np.where(passes, self.penalty * self.conductance, 0.0)
        return np.where(passes, self.multiplier, 0.0) + eps * self.step, eps

    def spread(self, s: Side, state: State, f: Floats, R: Floats) -> None:
        """Add f (q,) to the field's rows of R, primary nodes gaining what secondary ones lose."""
        o, rows = s.other, state.layout.scalar(R, self.field)
        kernels.spread(s.conn, s.count, s.facet, s.N, o.conn, o.count, s.partner, s.M, f, rows)

    def unknowns(self, state: State, nodes: Ints) -> tuple[Floats, Ints, Ints]:
        """Zero matrices over the displacements of ``nodes`` (m, n), node by node, and then the field's values."""
        m, n = nodes.shape
        own = np.repeat(state.layout.columns(self.field), n)
        columns = np.concatenate([np.tile(state.layout.displacement, n), own])
        return np.zeros((m, 4 * n, 4 * n)), np.hstack([np.repeat(nodes, 3, axis=1), nodes]), columns


class Passages(list[Passage]):
    """All that passes from one side; given back by retries as a whole."""

    def snapshot(self) -> list[dict[str, Floats]]:
        return [{k: getattr(q, k).copy() for k in q.memory} for q in self]

    def restore(self, saved: list[dict[str, Floats]]) -> None:
        for q, values in zip(self, saved, strict=True):
            for k, v in values.items():
                setattr(q, k, v.copy())


def solutes(groups: Iterable[Group]) -> list[str]:
    """Fields of the concentrations that the groups have."""
    return list(dict.fromkeys(f for g in groups for f in g.fields if f not in (DISPLACEMENT.name, PRESSURE.name)))


class Steps:
    """What an augmentation sees of the differences: their squares and the largest, field by field."""

    def __init__(self) -> None:
        self.square: dict[str, float] = {}
        self.worst: dict[str, float] = {}

    def add(self, q: Passage, at: Bools | slice = slice(None)) -> None:
        step = q.step[at]
        self.square[q.field] = self.square.get(q.field, 0.0) + float((step**2).sum())
        self.worst[q.field] = max(self.worst.get(q.field, 0.0), float(np.abs(step).max(initial=0.0)))

    def loose(self, traction: float, tolerance: float, ptol: float, ctol: float, RT: float) -> bool:
        """Are differences too large, by themselves or their squares over that of the ``traction``?"""
        for field, square in self.square.items():
            fluid = field == PRESSURE.name
            scale = (traction if fluid else traction / RT) or 1.0
            if 0 < tolerance < square / scale or 0 < (ptol if fluid else ctol) < self.worst[field]:
                return True
        return False
