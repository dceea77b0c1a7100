"""Flux of a solute through a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..fields import concentration
from ..kernels.surface import add_scalars, flow, flow_stiffness
from . import register
from .base import Floats, Matrices, Number, SurfaceLoad, scalar

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class SoluteFlux(SurfaceLoad):
    """Moles of a solute leaving per area and time: dt int N flux |a|. FEBio User Manual, "Solute Flux".

    ``solute``: its number in the model, from 1; ``linear`` takes the areas of the reference.
    """

    flux: Number = 1.0
    solute: int = 1
    linear: bool = False
    parameters = ("flux",)

    @property
    def symmetric(self) -> bool:
        return not self.tangent

    @property
    def tangent(self) -> bool:
        return not self.linear

    @property
    def field(self) -> str:
        """Name of the solute's nodal field."""
        return concentration(self.solute).name

    def residual(self, state: State, R: Floats) -> None:
        x = self.positions(state, self.linear)
        for p in self.surface:
            f = np.zeros(p.conn.shape)
            flow(x, state.velocity, *p.geometry, self.sign * scalar(self.flux, state.time, p), False, f)
            add_scalars(p.conn, state.dt * f, state.layout.scalar(R, self.field))

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        if not self.tangent:
            return []
        x, out = self.positions(state), []
        for p in self.surface:
            K, nodes, columns = self.matrices(state, p, self.field)
            q = self.sign * scalar(self.flux, state.time, p)
            flow_stiffness(x, state.velocity, *p.geometry, q, False, True, state.dt, K)
            out.append((K, nodes, columns))
        return out


register(SoluteFlux, "soluteflux")
