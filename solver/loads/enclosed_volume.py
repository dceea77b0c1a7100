"""Pressures by the volume that a surface encloses."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..kernels.surface import normal_force, normal_stiffness
from ..values import as_value
from . import register
from .base import Floats, Matrices, Number, SurfaceLoad
from .springs import ORIGIN

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class Enclosing(SurfaceLoad):
    """Tractions p n by the volume V that the surface encloses; V0 is V as they begin to act.

    V = 1/3 int x . n da over the surface. The tangent is that of a given pressure; its change, coupling all nodes, is
    left to quasi-Newton updates (as in FEBio).
    """

    symmetric_stiffness: bool = True
    start: float = field(init=False, default=0.0)

    @property
    def symmetric(self) -> bool:
        return self.symmetric_stiffness

    @property
    def tangent(self) -> bool:
        return True

    def begin(self, state: State, groups: Any) -> None:
        self.start = self.volume(state)

    def pressure(self, state: State) -> float:
        """p."""
        raise NotImplementedError

    def volume(self, state: State) -> float:
        """V, by the area vectors of the forces: int N_a n da is dV/dx_a of a closed surface."""
        x = self.positions(state)
        return sum(float((x[p.conn] * f).sum()) for p, f in self._areas(state, 1.0)) / 3.0

    def _areas(self, state: State, p: float) -> list[Any]:
        """Each patch with its facets' forces (f, n, 3) under a traction p along the normal."""
        x, out = self.positions(state), []
        for patch in self.surface:
            f = np.zeros((*patch.conn.shape, 3))
            normal_force(x, *patch.geometry, np.array([p]), f)
            out.append((patch, f))
        return out

    def residual(self, state: State, R: Floats) -> None:
        for patch, f in self._areas(state, self.sign * self.pressure(state)):
            self.add(state, patch, f, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        x, p, out = self.positions(state), np.array([self.sign * self.pressure(state)]), []
        for patch in self.surface:
            K, nodes, columns = self.matrices(state, patch)
            normal_stiffness(x, *patch.geometry, p, self.symmetric_stiffness, K)
            out.append((K, nodes, columns))
        return out


@dataclass(eq=False)
class EnclosedVolume(Enclosing):
    """Holds V: p = lambda + eps (V - V0).

    ``penalty`` eps is negative on a surface whose normals point out of V, so that a volume that has grown is pressed
    together. FEBio user manual, "Volume constraint".
    """

    penalty: Number = 0.0
    laugon: bool = False
    tolerance: float = 0.0
    parameters = ("penalty",)
    multiplier: float = field(init=False, default=0.0)

    @property
    def augments(self) -> bool:
        return self.laugon and self.tolerance > 0.0

    def begin(self, state: State, groups: Any) -> None:
        super().begin(state, groups)
        self.multiplier = 0.0

    def snapshot(self) -> Any:
        return self.multiplier

    def restore(self, saved: Any) -> None:
        self.multiplier = saved

    def _growth(self, state: State) -> float:
        """eps (V - V0)."""
        return float(as_value(self.penalty)(state.time, ORIGIN)[0]) * (self.volume(state) - self.start)

    def pressure(self, state: State) -> float:
        return self.multiplier + self._growth(state)

    def augment(self, done: int, state: State) -> bool:
        """Renew the multiplier; True where eps (V - V0) is small beside the pressure."""
        more = self._growth(state)
        if abs(more) <= self.tolerance * abs(self.multiplier + more):
            return True
        self.multiplier += more
        return False


@dataclass(eq=False)
class IdealGas(Enclosing):
    """A gas at constant temperature: p = P0 V0 / V along the normal. FEBio user manual, "Ideal Gas Pressure"."""

    P0: Number = 0.0
    parameters = ("P0",)

    def pressure(self, state: State) -> float:
        return float(as_value(self.P0)(state.time, ORIGIN)[0]) * self.start / self.volume(state)


register(IdealGas, "ideal gas pressure")
