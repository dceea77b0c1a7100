"""A force spread evenly over a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..kernels.surface import areas, traction_force
from . import register
from .base import Floats, Number, SurfaceLoad, Vector, scalar, vector

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class Force(SurfaceLoad):
    """Traction scale * force / A per reference area, A the reference area of the whole surface.

    FEBio User Manual, "Surface Force".
    """

    force: Vector = (0.0, 0.0, 0.0)
    scale: Number = 1.0
    parameters = ("force", "scale")
    vectors = ("force",)

    def residual(self, state: State, R: Floats) -> None:
        x = self.positions(state, reference=True)
        area = 0.0
        for p in self.surface:
            A = np.empty(len(p.conn))
            areas(x, p.conn, p.element.dN, p.element.weights, A)
            area += float(A.sum())
        for p in self.surface:
            T = vector(self.force, state.time, p.points, p.items)
            T = T * scalar(self.scale, state.time, p)[:, None] / area
            f = np.zeros((*p.conn.shape, 3))
            traction_force(x, *p.geometry, self.sign * T, f)
            self.add(state, p, f, R)


register(Force, "force")
