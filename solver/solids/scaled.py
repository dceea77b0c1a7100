"""A solid times a factor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..kernels.push import add_scaled
from ..points import Points
from .base import Floats, Number, Property, Solid, wanted
from .registry import register
from .uncoupled import Uncoupled, distortional, distortional_energy


@dataclass(eq=False)
class _Scaled:
    solid: Solid | None = None
    scale: Number = 1.0
    parameters: ClassVar[tuple[str, ...]] = ("scale",)
    properties: ClassVar[dict[str, Property]] = {"solid": Property("solid")}

    def _factor(self, pts: Points) -> Floats:
        return np.ascontiguousarray(np.broadcast_to(self.par(pts)[:, 0], (pts.n,)))  # type: ignore[attr-defined]

    def _add(self, pts: Points, s: Floats, c: Floats | None, whole: bool) -> None:
        solid, within = self.solid, self.inner(pts)  # type: ignore[attr-defined]
        s0 = np.zeros((pts.n, 6))
        c0 = None if c is None else np.zeros((pts.n, 6, 6))
        (solid.stress if whole else distortional(solid))(within, s0, c0)  # type: ignore[union-attr, arg-type]
        add_scaled(self._factor(pts), s0, wanted(c0), s, wanted(c))


@dataclass(eq=False)
class Scaled(_Scaled, Solid):
    """sigma = scale sigma_0."""

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c, True)

    def energy(self, pts: Points) -> Floats:
        return self._factor(pts) * self.solid.energy(self.inner(pts))  # type: ignore[union-attr]


@dataclass(eq=False)
class ScaledUncoupled(_Scaled, Uncoupled):
    """The distortional stress times ``scale``."""

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c, False)

    def dev_energy(self, pts: Points) -> Floats:
        return self._factor(pts) * distortional_energy(self.solid, self.inner(pts))  # type: ignore[arg-type, operator]


register(Scaled, "scaled elastic")
register(ScaledUncoupled, "scaled uncoupled")
