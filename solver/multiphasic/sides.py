"""What a membrane sees of the mixtures on its two faces, at its points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FRONT, BACK = 0, 1  # FEBio's external and internal side


@dataclass(slots=True)
class Sides:
    """n points, M solutes of the model: effective concentrations c (n, 2, M) in front and behind, areal strain (n,)
    (current over reference area of the front), thickness h (n,)."""

    c: Floats
    strain: Floats
    h: Floats

    @classmethod
    def of(cls, n: int, solutes: int) -> Sides:
        """Nothing is known yet."""
        return cls(np.zeros((n, 2, solutes)), np.ones(n), np.ones(n))

    def part(self, q: slice) -> Sides:
        """Those of some points (views)."""
        return Sides(self.c[q], self.strain[q], self.h[q])
