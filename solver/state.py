"""The state of a run: nodal fields and, per block, integration point fields."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .problem import Problem

Floats = NDArray[np.float64]


@dataclass
class State:
    """Nodal values d (node, column) with columns u, v, w[, p]; velocity and acceleration (node, 3).

    ``*_old`` are the values at the last converged step. ``reaction`` (node, 3) is the internal force. Two rows of each
    rigid body follow the nodes (:mod:`.rigid`).
    """

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
        n, c = len(X), 4 if problem.biphasic else 3

        def zeros(k: int) -> Floats:
            return np.zeros((n, k))

        return cls(X, zeros(c), zeros(c), zeros(3), zeros(3), zeros(3), zeros(3), zeros(3))

    @property
    def u(self) -> Floats:
        return self.d[:, :3]

    @property
    def p(self) -> Floats | None:
        return self.d[:, 3] if self.d.shape[1] > 3 else None

    @property
    def x(self) -> Floats:
        """Current positions (node, 3)."""
        return self.X + self.d[:, :3]

    def copy(self) -> State:
        out = State(**{k: (v.copy() if isinstance(v, np.ndarray) else v) for k, v in vars(self).items()})  # type: ignore[arg-type]
        out.X = self.X
        out.extra = {k: v.copy() for k, v in self.extra.items()}
        return out
