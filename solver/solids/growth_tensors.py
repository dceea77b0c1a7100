"""Growth tensors Fg = iso I + (ani - 1) n dyad n about a fiber direction n."""

from __future__ import annotations

from dataclasses import field
from typing import Any, ClassVar

import numpy as np

from ..matrices import det
from ..points import Points
from ..record import variable_record
from ..values import as_value
from .base import Floats, Number, Property
from .fiber import directions
from .registry import register


@variable_record
class Growth:
    """``tensor(pts)`` (1|n, 3, 3) and ``density(pts)`` (1|n,), the mass added per mass."""

    fiber: Any = field(default=None, kw_only=True)
    parameters: ClassVar[tuple[str, ...]] = ()
    options: ClassVar[tuple[str, ...]] = ()
    properties: ClassVar[dict[str, Property]] = {"fiber": Property("direction", optional=True, default="vector")}

    def factors(self, pts: Points) -> tuple[Floats, Floats]:
        """iso and ani, each (1|n,)."""
        raise NotImplementedError

    def p(self, name: str, pts: Points) -> Floats:
        return as_value(getattr(self, name))(pts.t, pts.X, pts.e)

    def tensor(self, pts: Points) -> Floats:
        iso, ani = (x[:, None, None] for x in self.factors(pts))
        n = directions(self.fiber, pts)
        return iso * np.eye(3) + (ani - 1.0) * n[:, :, None] * n[:, None, :]

    def density(self, pts: Points) -> Floats:
        return det(self.tensor(pts))


@variable_record
class VolumeGrowth(Growth):
    """Fg = multiplier I."""

    multiplier: Number = 1.0
    parameters = ("multiplier",)

    def factors(self, pts: Points) -> tuple[Floats, Floats]:
        g = self.p("multiplier", pts)
        return g, np.ones_like(g)


@variable_record
class AreaGrowth(Growth):
    """iso = multiplier^1/2, ani = 2 - iso: growth across the fiber."""

    multiplier: Number = 1.0
    parameters = ("multiplier",)

    def factors(self, pts: Points) -> tuple[Floats, Floats]:
        g = np.sqrt(self.p("multiplier", pts))
        return g, 2.0 - g


@variable_record
class FiberGrowth(Growth):
    """iso = 1, ani = multiplier."""

    multiplier: Number = 1.0
    parameters = ("multiplier",)

    def factors(self, pts: Points) -> tuple[Floats, Floats]:
        g = self.p("multiplier", pts)
        return np.ones_like(g), g


@variable_record
class GeneralGrowth(Growth):
    """iso and ani given."""

    iso: Number = 1.0
    ani: Number = 1.0
    parameters = ("iso", "ani")

    def factors(self, pts: Points) -> tuple[Floats, Floats]:
        return self.p("iso", pts), self.p("ani", pts)


register(VolumeGrowth, "volume growth", "growth")
register(AreaGrowth, "area growth", "growth")
register(FiberGrowth, "fiber growth", "growth")
register(GeneralGrowth, "general growth", "growth")
