"""Nodes that keep their angle about the z axis, by penalty or augmented Lagrangian."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..action import Action
from .base import Floats, Ints, Matrices

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class Azimuth(Action):
    """-P (lambda + penalty c) acts on a node: c = e - e0, its radial unit vectors now and in the reference.

    P = (1 - e e) / l, l the distance from the axis. FEBio's "azimuth constraint".
    """

    nodes: Ints
    penalty: float = 0.0
    laugon: bool = False
    tolerance: float = 0.1
    minaug: int = 0
    maxaug: int = 0
    multipliers: Floats = field(init=False, repr=False)  # lambda (node, 2)

    def __post_init__(self) -> None:
        self.multipliers = np.zeros((len(self.nodes), 2))

    def begin(self, state: State, groups: list[Group]) -> None:
        self.multipliers = np.zeros((len(self.nodes), 2))

    @property
    def augments(self) -> bool:
        return self.laugon

    @property
    def joins(self) -> Ints:
        return self.nodes

    def snapshot(self) -> Floats:
        return self.multipliers.copy()

    def restore(self, saved: Floats) -> None:
        self.multipliers = saved.copy()

    def cliques(self) -> list[Ints]:
        return [self.nodes[:, None]]

    def _turned(self, state: State) -> tuple[Floats, Floats, Floats, Floats]:
        """l (node,), e (node, 2), P (node, 2, 2) and lambda + penalty c (node, 2)."""
        r, R = state.x[self.nodes, :2], state.X[self.nodes, :2]
        l = np.linalg.norm(r, axis=1)
        e = r / l[:, None]
        c = e - R / np.linalg.norm(R, axis=1)[:, None]
        P = (np.eye(2) - e[:, :, None] * e[:, None, :]) / l[:, None, None]
        return l, e, P, self.multipliers + self.penalty * c

    def residual(self, state: State, R: Floats) -> None:
        _, _, P, L = self._turned(state)
        state.layout.u(R)[self.nodes, :2] -= np.einsum("nij,nj->ni", P, L)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        """penalty P P - (P L e + e P L + (e . L) P) / l."""
        l, e, P, L = self._turned(state)
        PL = np.einsum("nij,nj->ni", P, L)[:, :, None] * e[:, None, :]
        bent = PL + np.swapaxes(PL, 1, 2) + (e * L).sum(axis=1)[:, None, None] * P
        K = self.penalty * P @ P - bent / l[:, None, None]
        return [(K, np.repeat(self.nodes[:, None], 2, axis=1), state.layout.displacement[:2])]

    def augment(self, done: int, state: State) -> bool:
        """Renew the multipliers of nodes whose have not settled; FEBio counts augmentations node by node."""
        if not self.laugon:
            return True
        new = self._turned(state)[3]
        old, size = np.linalg.norm(self.multipliers, axis=1), np.linalg.norm(new, axis=1)
        some = np.where(size > 0, size, 1.0)
        settled = np.where(old == 0.0, size == 0.0, np.abs(size - old) < self.tolerance * some)
        count = done + 1 + np.arange(len(self.nodes))
        settled &= ~((self.minaug > 0) & (count < self.minaug))
        settled |= (self.maxaug > 0) & (count >= self.maxaug)
        self.multipliers = np.where(settled[:, None], self.multipliers, new)
        return bool(settled.all())
