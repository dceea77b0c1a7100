"""A rigid wall: a plane that the nodes of a surface may not pass, by penalty or augmented Lagrangian.

FEBio user manual, "Rigid wall".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..action import Action
from ..elements import nodal
from ..values import Value, as_value
from .base import Floats, Ints, Matrices, Number, Patch

if TYPE_CHECKING:
    from ..state import State

ORIGIN = np.zeros((1, 3))
NO_FORCE = 1e-10  # of the multipliers' norm, below which FEBio does not ask how it changed


@dataclass(eq=False)
class RigidWall(Action):
    """f = A max(0, lambda + eps g) n with the gap g = offset - |a| (a . x - d) and n = a / |a|.

    ``plane``: a (3,) and d, of the plane a . x = d; A: the reference area of a node. The multipliers lambda
    become max(0, lambda + eps g) until their norm changes by less than ``tolerance`` of itself.
    """

    touches: ClassVar[bool] = True
    surface: tuple[Patch, ...]
    plane: tuple[Value, Value, Value, Value]
    penalty: Number = 0.0
    offset: Number = 0.0
    tolerance: float = 0.0
    laugon: int = 0
    nodes: Ints = field(init=False)
    multipliers: Floats = field(init=False)
    _areas: Floats | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        self.nodes = np.unique(np.concatenate([p.conn.ravel() for p in self.surface]))
        self.multipliers = np.zeros(len(self.nodes))

    @property
    def augments(self) -> bool:
        return self.laugon == 1

    def begin(self, state: State, groups: Any) -> None:
        self.multipliers = np.zeros(len(self.nodes))

    def snapshot(self) -> Any:
        return self.multipliers.copy()

    def restore(self, saved: Any) -> None:
        self.multipliers = saved.copy()

    def cliques(self) -> list[Ints]:
        return [self.nodes[:, None]]

    def _pressed(self, state: State) -> tuple[Floats, Floats, float]:
        """lambda + eps g (node,), the normal, and eps."""
        eps, offset, *plane = (
            float(as_value(v)(state.time, ORIGIN)[0]) for v in (self.penalty, self.offset, *self.plane)
        )
        a = np.array(plane[:3])
        size = float(np.linalg.norm(a))
        gap = offset - size * (state.x[self.nodes] @ a - plane[3])
        return self.multipliers + eps * gap, a / size if size > 0.0 else a, eps

    def _area(self, state: State) -> Floats:
        if self._areas is None:
            at = [np.searchsorted(self.nodes, p.conn.ravel()) for p in self.surface]
            A = [nodal.areas(p.element.name, state.X[p.conn]).ravel() for p in self.surface]
            self._areas = np.asarray(np.bincount(np.concatenate(at), np.concatenate(A), len(self.nodes)), float)
        return self._areas

    def residual(self, state: State, R: Floats) -> None:
        p, n, _ = self._pressed(state)
        state.layout.u(R)[self.nodes] += (self._area(state) * np.maximum(p, 0.0))[:, None] * n

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        p, n, eps = self._pressed(state)
        on = p >= 0.0
        K = (eps * self._area(state)[on])[:, None, None] * np.outer(n, n)
        return [(K, np.repeat(self.nodes[on][:, None], 3, axis=1), state.layout.displacement)]

    def augment(self, done: int, state: State) -> bool:
        """Renew the multipliers; True where their norm has settled."""
        new = np.maximum(self._pressed(state)[0], 0.0)
        n0, n1 = float(np.linalg.norm(self.multipliers)), float(np.linalg.norm(new))
        if (abs(n1 - n0) / n1 if n1 > NO_FORCE else 0.0) < self.tolerance:
            return True
        self.multipliers = new
        return False
