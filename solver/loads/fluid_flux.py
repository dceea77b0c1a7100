"""Fluid flux through a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..fields import PRESSURE
from ..kernels.surface import add_scalars, flow, flow_stiffness
from . import register
from .base import Floats, Matrices, Number, SurfaceLoad, scalar

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class FluidFlux(SurfaceLoad):
    """Volume of fluid leaving per area and time, relative to the solid; of the mixture where ``mixture``.

    dt int N (flux |a| - v . a), the last term where ``mixture``, but in steady states.
    FEBio User Manual, "Fluid Flux". ``linear`` takes the areas of the reference.
    """

    flux: Number = 1.0
    linear: bool = False
    mixture: bool = False
    parameters = ("flux",)

    @property
    def symmetric(self) -> bool:
        return not self.tangent

    @property
    def tangent(self) -> bool:
        return not self.linear or self._moves

    @property
    def _moves(self) -> bool:
        return self.mixture and not self.steady

    def residual(self, state: State, R: Floats) -> None:
        x = self.positions(state, self.linear)
        for p in self.surface:
            f = np.zeros(p.conn.shape)
            q = self.sign * scalar(self.flux, state.time, p)
            flow(x, state.velocity, *p.geometry, q, self._moves, f)
            add_scalars(p.conn, state.dt * f, state.layout.scalar(R, PRESSURE.name))

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        if not self.tangent:
            return []
        x, v, out = self.positions(state, self.linear), state.velocity, []
        for p in self.surface:
            K, nodes, columns = self.matrices(state, p, PRESSURE.name)
            q = self.sign * scalar(self.flux, state.time, p)
            flow_stiffness(x, v, *p.geometry, q, self._moves, not self.linear, state.dt, K)
            out.append((K, nodes, columns))
        return out


register(FluidFlux, "fluidflux")
