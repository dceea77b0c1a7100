"""Solids deposited one after the other, each free of stress when it is laid down."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..matrices import det, inv
from ..points import Points
from ..values import as_value
from .base import Floats, Number, Property, Solid, deformed, unwritten
from .registry import register

_HEAD = 11  # number of generations, start of the last, F of the last state


@dataclass(eq=False)
class Generation(Solid):
    """One solid and the time at which it is laid down."""

    start_time: Number = 0.0
    solid: Solid | None = None
    parameters = ("start_time",)
    properties = {"solid": Property("solid")}

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self.solid.stress(self.inner(pts), s, c)  # type: ignore[union-attr]

    def energy(self, pts: Points) -> Floats:
        return self.solid.energy(self.inner(pts))  # type: ignore[union-attr]


@dataclass(eq=False)
class Multigeneration(Solid):
    """sigma = sum of sigma_g(F F_g^-1) over the generations laid down so far, F_g the deformation at that time.

    A generation joins in the first step that ends at or after its start time, free of stress at the start of that
    step, one generation a step. History: number of generations, start time of the last, F of the last state, and
    F_g^-1 of each. Ateshian & Ricken, Biomech. Model. Mechanobiol. 9 (2010) 689.
    """

    generation: tuple[Generation, ...] = ()
    properties = {"generation": Property("generation", many=True, default="generation")}
    history: int = field(default=0, init=False, repr=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.history = _HEAD + 9 * len(self.generation)

    def initial(self, n: int) -> Floats:
        out = np.zeros((n, self.history))
        out[:, 0] = 1.0
        out[:, 2:] = np.tile(np.eye(3).ravel(), 1 + len(self.generation))
        return out

    def _start(self, g: int, pts: Points) -> float:
        return float(as_value(self.generation[g].start_time)(pts.t, pts.X, pts.e)[0])

    def _latest(self, pts: Points) -> int:
        """Index of the generation to be laid down by now."""
        for g in range(1, len(self.generation)):
            if pts.t < self._start(g, pts):
                return g - 1
        return len(self.generation) - 1

    def _states(self, pts: Points) -> list[tuple[Generation, Points, Floats]]:
        """(generation, points as it sees them, J of its inverse reference) for those laid down."""
        at, h = self.offset, self.history
        old = self.initial(pts.n) if pts.old is None else pts.old[:, at : at + h]
        now = self._lay_down(pts, old)
        if pts.new is not None:
            pts.new[:, at : at + h] = now
        out = []
        for g in range(int(now[0, 0])):
            Fi = now[:, _HEAD + 9 * g : _HEAD + 9 + 9 * g].reshape(-1, 3, 3)
            out.append((self.generation[g], deformed(pts, pts.F @ Fi), det(Fi)))
        return out

    def _lay_down(self, pts: Points, old: Floats) -> Floats:
        """History at the present state: a generation due by now joins in the state that the step starts from."""
        now = old.copy()
        born, count = self._start(self._latest(pts), pts), int(old[0, 0])
        if born > old[0, 1] and count < len(self.generation):
            at = _HEAD + 9 * count
            now[:, at : at + 9] = inv(old[:, 2:_HEAD].reshape(-1, 3, 3)).reshape(-1, 9)
            now[:, 0], now[:, 1] = count + 1, born
        now[:, 2:_HEAD] = pts.F.reshape(-1, 9)
        return now

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        for material, state, _ in self._states(self.inner(pts)):
            material.stress(state, s, c)

    def energy(self, pts: Points) -> Floats:
        parts = (m.energy(state) / J for m, state, J in self._states(self.inner(unwritten(pts))))
        return sum(parts, start=0.0 * pts.J)


register(Generation, "generation", "generation")
register(Multigeneration, "multigeneration")
