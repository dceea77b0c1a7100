"""Normal traction on a mixture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..fields import PRESSURE
from ..kernels.surface import normal_force, normal_stiffness, pressure_columns
from . import register
from .base import Floats, Matrices, Number, Patch, SurfaceLoad, scalar

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class NormalTraction(SurfaceLoad):
    """Traction (traction - p) n where ``effective`` (p the fluid pressure), else traction n.

    FEBio User Manual, "Mixture Normal Traction". ``linear`` takes area and normal of the reference;
    ``symmetric_stiffness`` the symmetric part of the tangent without the pressure's column.
    """

    traction: Number = 1.0
    linear: bool = False
    effective: bool = False
    symmetric_stiffness: bool = False
    parameters = ("traction",)

    @property
    def symmetric(self) -> bool:
        return self.linear or self.symmetric_stiffness

    @property
    def tangent(self) -> bool:
        return not self.linear

    def _normal(self, state: State, p: Patch) -> Floats:
        """Traction along the normal at the points."""
        P, nodal = scalar(self.traction, state.time, p), self.pressure_of(state)
        if self.effective and nodal is not None:
            P = P - (nodal[p.conn] @ p.element.N.T).ravel()
        return self.sign * P

    def residual(self, state: State, R: Floats) -> None:
        x = self.positions(state, self.linear)
        for p in self.surface:
            f = np.zeros((*p.conn.shape, 3))
            normal_force(x, *p.geometry, self._normal(state, p), f)
            self.add(state, p, f, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        if self.linear:
            return []
        x, out = self.positions(state), []
        column = self.effective and not self.symmetric_stiffness and self.pressure_of(state) is not None
        for p in self.surface:
            K, nodes, columns = self.matrices(state, p, *([PRESSURE.name] if column else []))
            normal_stiffness(x, *p.geometry, self._normal(state, p), self.symmetric_stiffness, K)
            if column:
                pressure_columns(x, *p.geometry, self.sign, K)
            out.append((K, nodes, columns))
        return out


register(NormalTraction, "normal_traction")
