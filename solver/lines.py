"""A block of lines at work: trusses and beams, straight between the first two nodes of each element, as in FEBio.

Volumes are those of the reference, area times length; there is no deformation gradient (F = 1).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .group import Chunk, ElementFailure, Floats, Group
from .state import State


class Lines(Group):
    """``length`` (m,) and ``axis`` (m, 3) in the reference; ``dS`` (m, g) length at the points;
    ``slope`` (m, g, n) derivatives of the shape functions by length; ``u`` (node, 3) displacements at the time within
    the step that internal forces are taken at."""

    def _measure(self, X: Floats) -> None:
        self.deforms = False
        d = X[self.conn[:, 1]] - X[self.conn[:, 0]]
        self.length = np.sqrt((d * d).sum(axis=1))
        if not (self.length > 0).all():
            e = self.block.ids[int(np.argmin(self.length > 0))]
            raise ElementFailure(f"element {e} of part {self.block.name!r} has no length")
        self.axis = d / self.length[:, None]
        half = 0.5 * self.length
        self.dS = half[:, None] * self.element.weights
        self.slope = self.dN[None, :, :, 0] / half[:, None, None]
        self.wJ0[...] = getattr(self.block.physics, "area") * self.dS  # noqa: B009
        self.iJ0[...] = 0.0

    def update(self, c: Chunk, state: State, u: Floats, drive: list[Any] | None = None) -> None:
        self.u = u
        super().update(c, state, u, drive)
