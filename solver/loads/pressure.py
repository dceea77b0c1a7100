"""Pressure on a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..kernels.surface import normal_force, normal_stiffness
from . import register
from .base import Floats, Matrices, Number, SurfaceLoad, scalar

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class Pressure(SurfaceLoad):
    """Traction -pressure n per current area, or per reference area and normal where ``linear``.

    FEBio User Manual, "Pressure Load". ``symmetric_stiffness`` takes the symmetric part of the tangent.
    """

    pressure: Number = 0.0
    linear: bool = False
    symmetric_stiffness: bool = True
    parameters = ("pressure",)

    @property
    def symmetric(self) -> bool:
        return self.symmetric_stiffness or self.linear

    @property
    def tangent(self) -> bool:
        return not self.linear

    def residual(self, state: State, R: Floats) -> None:
        x = self.positions(state, self.linear)
        for p in self.surface:
            f = np.zeros((*p.conn.shape, 3))
            normal_force(x, *p.geometry, -self.sign * scalar(self.pressure, state.time, p), f)
            self.add(state, p, f, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        if self.linear:
            return []
        x, out = self.positions(state), []
        for p in self.surface:
            K, nodes, columns = self.matrices(state, p)
            P = -self.sign * scalar(self.pressure, state.time, p)
            normal_stiffness(x, *p.geometry, P, self.symmetric_stiffness, K)
            out.append((K, nodes, columns))
        return out


register(Pressure, "pressure")
