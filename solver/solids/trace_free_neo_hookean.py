"""Neo-Hookean solid whose stress has no trace."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .hyperelastic import Hyperelastic, columns
from .registry import register


@dataclass(eq=False)
class TraceFreeNeoHookean(Hyperelastic):
    """W = mu ln((I1/3)^(3/2) / J)."""

    mu: Number = 0.0
    parameters = ("mu",)

    def derivatives(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        mu = self.par(pts)[:, 0]
        return columns(pts, 1.5 * mu / I1, 0.0, -1.5 * mu / I1**2, 0.0, 0.0, -mu / J, mu / J**2)

    def potential(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        return self.par(pts)[:, 0] * np.log((I1 / 3.0) ** 1.5 / J)


register(TraceFreeNeoHookean, "trace-free neo-Hookean")
