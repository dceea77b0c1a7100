"""Lines tied to lines, and lines that slide along lines: constraints of FEBio that act as contacts of nodes do."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..action import Action, Matrices
from ..problem import Progress
from ..values import as_value
from .surface import Floats, Ints

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State

NO_FORCE = 1e-10  # of the multipliers' norm, below which FEBio does not ask how it changed


@dataclass(eq=False)
class Lines(Action):
    """Nodes of ``primary`` lines (k, 2) held to the closest points of ``secondary`` ones (l, 2).

    A node stands for half the reference length of the lines around it (m,). It acts on itself and on both ends of its
    partner, a row of ``secondary`` or -1, with the weights (1, at - 1, -at), ``at`` (m,) being its place there.
    """

    primary: Ints
    secondary: Ints
    penalty: Any = 1.0  # a Value
    laugon: bool = False
    tolerance: float = 0.01
    minaug: int = 0
    maxaug: int = 10
    names: tuple[str, str] = ("", "")
    nodes: Ints = field(init=False)
    retraces: ClassVar[bool] = False
    memory: ClassVar[tuple[str, ...]] = ("partner", "at", "gap", "multiplier")
    drains: ClassVar[bool] = False

    def __post_init__(self) -> None:
        self.penalty = as_value(self.penalty)
        self.nodes = np.unique(self.primary)

    @property
    def augments(self) -> bool:
        return self.laugon

    def begin(self, state: State, groups: list[Group]) -> None:
        m, X = len(self.nodes), state.X
        half = np.linalg.norm(X[self.primary[:, 1]] - X[self.primary[:, 0]], axis=1) / 2
        ends = np.searchsorted(self.nodes, self.primary.ravel())
        self.weight = np.bincount(ends, np.repeat(half, 2), m)
        self.partner, self.at = np.full(m, -1), np.zeros(m)
        self.gap, self.multiplier = np.zeros((m, 3)), np.zeros((m, 3))

    def closest(self, x: Floats, beyond: float) -> tuple[Ints, Floats]:
        """Lines closest to the nodes, and places there; -1 where all projections lie ``beyond`` their ends."""
        a, b = x[self.secondary[:, 0]], x[self.secondary[:, 1]]
        e, p = b - a, x[self.nodes]
        long2 = (e * e).sum(axis=1)
        at = ((p[:, None] - a) * e).sum(axis=2) / np.where(long2 > 0.0, long2, 1.0)
        if np.isinf(beyond):
            at = np.clip(at, 0.0, 1.0)
        far = ((p[:, None] - a - at[..., None] * e) ** 2).sum(axis=2)
        far[:, long2 == 0.0] = np.inf
        far[(at < -beyond) | (at > 1.0 + beyond)] = np.inf
        best, rows = far.argmin(axis=1), np.arange(len(p))
        return np.where(np.isfinite(far[rows, best]), best, -1), at[rows, best]

    def places(self, x: Floats) -> Floats:
        """Where the partners of the nodes are (m, 3)."""
        a, b = x[self.secondary[self.partner]].swapaxes(0, 1)
        return np.asarray(a + self.at[:, None] * (b - a))

    def scale(self, state: State) -> float:
        """The penalty at the present time."""
        return float(self.penalty(state.time, state.X[:1], np.zeros(1, np.int64))[0])

    def update(self, state: State, progress: Progress) -> None:
        raise NotImplementedError

    def pull(self, state: State) -> Floats:
        """Force per length on the nodes (m, 3), towards their partners."""
        raise NotImplementedError

    def moduli(self, state: State) -> Floats:
        """Its tangent over eps (m, 3, 3), as FEBio has it."""
        raise NotImplementedError

    def residual(self, state: State, R: Floats) -> None:
        f = np.where(self.partner >= 0, self.weight, 0.0)[:, None] * self.pull(state)
        a, b = self.secondary[self.partner].T
        Ru, at = state.layout.u(R), self.at[:, None]
        Ru[self.nodes] += f
        np.add.at(Ru, a, (at - 1.0) * f)
        np.add.at(Ru, b, -at * f)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        held = np.flatnonzero(self.partner >= 0)
        at, nodes = self.at[held], self._pairs()
        W = np.stack([np.ones(len(held)), at - 1.0, -at], axis=1)
        k = self.scale(state) * self.weight[held]
        K = np.einsum("m,ma,mb,mij->maibj", k, W, W, self.moduli(state)[held]).reshape(-1, 9, 9)
        return [(K, np.repeat(nodes, 3, axis=1), np.tile(state.layout.displacement, 3))]

    def _pairs(self) -> Ints:
        """Nodes that have a partner, and its ends (n, 3)."""
        held = self.partner >= 0
        return np.column_stack([self.nodes[held], self.secondary[self.partner[held]]])

    def cliques(self) -> list[Ints]:
        return [self._pairs()]

    def on_facets(self, what: str, state: State) -> None:
        """Lines have no facets."""

    def snapshot(self) -> Any:
        return {k: getattr(self, k).copy() for k in self.memory}

    def restore(self, saved: Any) -> None:
        for k, v in saved.items():
            setattr(self, k, v.copy())


@dataclass(eq=False)
class TiedLine(Lines):
    """A force -(L + eps g) per length holds each node to where it was closest to the other line at the start.

    g = x - q. ``max_distance`` (0: any): nodes farther away are left alone. FEBio User Manual, "Tied line".
    """

    max_distance: float = 0.0

    def begin(self, state: State, groups: list[Group]) -> None:
        super().begin(state, groups)
        self.partner, self.at = self.closest(state.x, 1e-5)
        self.update(state, Progress())
        if self.max_distance > 0.0:
            self.partner[np.linalg.norm(self.gap, axis=1) > self.max_distance] = -1
            self.update(state, Progress())

    def update(self, state: State, progress: Progress) -> None:
        held = (self.partner >= 0)[:, None]
        self.gap = np.where(held, state.x[self.nodes] - self.places(state.x), 0.0)

    def pull(self, state: State) -> Floats:
        return -(self.multiplier + self.scale(state) * self.gap)

    def moduli(self, state: State) -> Floats:
        return np.broadcast_to(np.eye(3), (len(self.nodes), 3, 3))

    def augment(self, done: int, state: State) -> bool:
        """L += eps g; ends where the relative change of |L| is below the tolerance."""
        if not self.laugon:
            return True
        new = -self.pull(state)
        n0, n1 = float(np.linalg.norm(self.multiplier)), float(np.linalg.norm(new))
        change = abs((n1 - n0) / n1) if n1 > NO_FORCE else 0.0
        ended = (change < self.tolerance and done >= self.minaug) or done >= self.maxaug
        if not ended:
            self.multiplier = new
        return ended


@dataclass(eq=False)
class SlideLine(Lines):
    """A force (L + eps g) n per length pulls each node to the closest point q of the other line, along which it slides.

    g = |q - x|, n = (q - x) / g; L (m, 1). A node keeps its place after ``seg_up`` iterations of a step (0: never)
    where another line has come closer. FEBio User Manual, "Slide line".
    """

    gaptol: float = 0.0
    seg_up: int = 0
    memory: ClassVar[tuple[str, ...]] = (*Lines.memory, "normal", "_rms")

    def begin(self, state: State, groups: list[Group]) -> None:
        super().begin(state, groups)
        self.gap, self.multiplier = self.gap[:, :1], self.multiplier[:, :1]
        self.normal, self._rms = np.zeros((len(self.nodes), 3)), np.zeros(1)
        self.update(state, Progress())

    def update(self, state: State, progress: Progress) -> None:
        partner, at = self.closest(state.x, np.inf)
        new = partner == self.partner
        if self.seg_up == 0 or progress.iterations <= self.seg_up:
            new[:] = True
        self.partner, self.at = np.where(new, partner, self.partner), np.where(new, at, self.at)
        to = self.places(state.x) - state.x[self.nodes]
        size = np.linalg.norm(to, axis=1)[:, None]
        self.gap[new] = size[new]
        self.normal[new] = np.where(size > 0.0, to / np.where(size > 0.0, size, 1.0), to)[new]

    def pull(self, state: State) -> Floats:
        return np.asarray((self.multiplier + self.scale(state) * self.gap) * self.normal)

    def moduli(self, state: State) -> Floats:
        """I - t t with t along the other line: its turning and the multiplier are left out."""
        a, b = state.x[self.secondary[self.partner]].swapaxes(0, 1)
        t = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
        return np.asarray(np.eye(3) - t[:, :, None] * t[:, None, :])

    def augment(self, done: int, state: State) -> bool:
        """L += eps g; ends where the relative change of |L| and the change of the mean gap are small."""
        if not self.laugon:
            return True
        new = self.multiplier + self.scale(state) * self.gap
        n0, n1 = float(np.linalg.norm(self.multiplier)), float(np.linalg.norm(new))
        open_ = self.gap[self.gap > 0.0]
        before, rms = (0.0 if done == 0 else float(self._rms[0])), float(np.sqrt((open_**2).sum() / max(len(open_), 1)))
        self._rms[0] = rms
        loose = 0 < self.tolerance < abs(n1 - n0) / (n1 or 1.0) or 0 < self.gaptol < abs(rms - before)
        ended = (not loose and done >= self.minaug) or done >= self.maxaug
        if not ended:
            self.multiplier = new
        return ended
