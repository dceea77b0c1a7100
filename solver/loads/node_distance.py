"""Two nodes held at a distance, by penalty or augmented Lagrangian. FEBio user manual, "Node distance"."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..action import Action
from ..values import as_value
from .base import Floats, Ints, Matrices, Number
from .springs import ORIGIN

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class NodeDistance(Action):
    """A force lambda + eps (l - l0) pulls the nodes (2,) together; l their distance.

    l0 is ``target``, or where ``relative`` that much more than l as the constraint begins to act, and never negative.
    """

    nodes: Ints
    penalty: Number = 0.0
    target: Number = 0.0
    relative: bool = True
    laugon: bool = False
    tolerance: float = 0.01
    minaug: int = 0
    maxaug: int = 10
    multiplier: float = field(init=False, default=0.0)
    _start: float = field(init=False, default=0.0)

    @property
    def augments(self) -> bool:
        return self.laugon and self.tolerance > 0.0

    @property
    def joins(self) -> Ints:
        return self.nodes

    def begin(self, state: State, groups: Any) -> None:
        self._start, self.multiplier = float(np.linalg.norm(self._line(state))), 0.0

    def snapshot(self) -> Any:
        return self.multiplier

    def restore(self, saved: Any) -> None:
        self.multiplier = saved

    def cliques(self) -> list[Ints]:
        return [self.nodes[None]]

    def _line(self, state: State) -> Floats:
        a, b = state.x[self.nodes]
        return np.asarray(b - a)

    def _held(self, state: State) -> tuple[float, float]:
        """eps and l0."""
        eps, target = (float(as_value(v)(state.time, ORIGIN)[0]) for v in (self.penalty, self.target))
        return eps, max(self._start + target if self.relative else target, 0.0)

    def residual(self, state: State, R: Floats) -> None:
        r, (eps, rest) = self._line(state), self._held(state)
        l = float(np.linalg.norm(r))
        if l > 0.0:
            f = (self.multiplier + eps * (l - rest)) / l * r
            np.add.at(state.layout.u(R), self.nodes, np.stack([f, -f]))

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        """A = F / l 1 + (eps - F / l) e e of the line's direction e."""
        r, (eps, rest) = self._line(state), self._held(state)
        l = float(np.linalg.norm(r))
        if l == 0.0:
            return []
        over = (self.multiplier + eps * (l - rest)) / l
        A = over * np.eye(3) + (eps - over) * np.outer(r, r) / l**2
        K = np.block([[A, -A], [-A, A]])
        return [(K[None], np.repeat(self.nodes, 3)[None], np.tile(state.layout.displacement, 2))]

    def augment(self, done: int, state: State) -> bool:
        """Renew the multiplier; True where it has settled."""
        eps, rest = self._held(state)
        new = self.multiplier + eps * (float(np.linalg.norm(self._line(state))) - rest)
        settled = abs(new - self.multiplier) < self.tolerance * abs(new) or new == self.multiplier
        if (settled and done >= self.minaug) or 0 <= self.maxaug <= done:
            return True
        self.multiplier = new
        return False
