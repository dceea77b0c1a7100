"""The state of a run: nodal fields and, per block, integration point fields."""

from __future__ import annotations

from dataclasses import field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .fields import Layout
from .problem import Problem
from .record import variable_record

Floats = NDArray[np.float64]


COPIED = ("d", "d_old", "velocity", "acceleration", "velocity_old", "acceleration_old", "reaction")


@variable_record
class State:
    """Nodal values d (node, column), their columns as ``layout`` says; velocity and acceleration (node, 3).

    ``*_old`` are the values at the last converged step. ``reaction`` (node, 3) is the internal force. Two rows of each
    rigid body follow the nodes (:mod:`.rigid`).
    """

    layout: Layout
    X: Floats
    d: Floats
    d_old: Floats
    velocity: Floats
    acceleration: Floats
    velocity_old: Floats
    acceleration_old: Floats
    reaction: Floats
    time: float = 0.0
    dt: float = 0.0
    extra: dict[str, Floats] = field(default_factory=dict)

    @classmethod
    def at_rest(cls, problem: Problem) -> State:
        X = problem.X
        if problem.bodies:
            X = np.vstack([X, *([b.centre, np.zeros(3)] for b in problem.bodies)])
        layout, n = problem.layout, len(X)

        def zeros(k: int) -> Floats:
            return np.zeros((n, k))

        c = layout.width
        return cls(layout, X, zeros(c), zeros(c), zeros(3), zeros(3), zeros(3), zeros(3), zeros(3))

    def of(self, name: str) -> Floats:
        """A field (node, component)."""
        return self.layout.view(self.d, name)

    def displacements(self, d: Floats) -> Floats:
        """The displacements (node, 3) of a nodal array, none where these are no unknowns."""
        return self.layout.u(d) if self.layout.moves else np.zeros_like(self.X)

    @property
    def u(self) -> Floats:
        """Displacements (node, 3)."""
        return self.layout.u(self.d) if self.layout.moves else np.zeros_like(self.X)

    @property
    def u_old(self) -> Floats:
        """Displacements (node, 3) at the last converged step."""
        return self.layout.u(self.d_old) if self.layout.moves else np.zeros_like(self.X)

    @property
    def p(self) -> Floats | None:
        """Fluid pressures (node,), None where the model has none."""
        return self.layout.scalar(self.d, "fluid pressure") if "fluid pressure" in self.layout else None

    @property
    def x(self) -> Floats:
        """Current positions (node, 3)."""
        return self.X + self.u

    def snapshot(self) -> dict[str, Any]:
        """All that a run changes."""
        arrays = {n: getattr(self, n).copy() for n in COPIED}
        return arrays | {"time": self.time, "dt": self.dt, "extra": {k: v.copy() for k, v in self.extra.items()}}

    def restore(self, saved: dict[str, Any]) -> None:
        """Take back a snapshot."""
        for n in COPIED:
            setattr(self, n, saved[n].copy())
        self.time, self.dt = saved["time"], saved["dt"]
        self.extra = {k: v.copy() for k, v in saved["extra"].items()}
