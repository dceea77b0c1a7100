"""Traction of fixed direction on a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..kernels.surface import traction_force
from . import register
from .base import Floats, Number, SurfaceLoad, Vector, scalar, vector

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class Traction(SurfaceLoad):
    """Traction scale * traction per current area, or per reference area where ``linear``.

    FEBio User Manual, "Traction Load". The change of area is left out of the tangent, as in FEBio.
    """

    traction: Vector = (0.0, 0.0, 0.0)
    scale: Number = 1.0
    linear: bool = False
    parameters = ("traction", "scale")
    vectors = ("traction",)

    def residual(self, state: State, R: Floats) -> None:
        x = self.positions(state, self.linear)
        for p in self.surface:
            T = vector(self.traction, state.time, p.points, p.items)
            T = T * scalar(self.scale, state.time, p)[:, None]
            f = np.zeros((*p.conn.shape, 3))
            traction_force(x, *p.geometry, self.sign * T, f)
            self.add(state, p, f, R)


register(Traction, "traction")
