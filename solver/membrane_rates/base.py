"""What the rate of a membrane reaction is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..law import Floats, Law
from ..multiphasic.sides import BACK, FRONT
from ..multiphasic.solution import Solution
from ..points import Points


@dataclass(eq=False)
class MembraneRate(Law):
    """Rate k (1|n,) at the points of a shell: ``rate``, its derivatives ``by_sides`` (n, 2, M) by the effective
    concentrations in front and behind, and ``by_strain`` (n,) by the areal strain."""

    remembers: ClassVar[bool] = False

    def rate(self, pts: Points, sol: Solution) -> Floats:
        raise NotImplementedError

    def by_sides(self, pts: Points, sol: Solution) -> Floats | None:
        return None

    def by_strain(self, pts: Points, sol: Solution) -> Floats | None:
        return None

    def begin_step(self, pts: Points, sol: Solution) -> None:
        """Nothing is remembered."""


@dataclass(eq=False)
class OfOneSolute(MembraneRate):
    """A rate that depends on the effective concentrations c_e, c_i of one solute in front and behind."""

    def of(self, sol: Solution, solute: int) -> tuple[Floats, Floats]:
        """c_e, c_i (n,)."""
        assert sol.sides is not None
        return sol.sides.c[:, FRONT, solute], sol.sides.c[:, BACK, solute]

    def spread(self, sol: Solution, solute: int, by_e: Floats, by_i: Floats) -> Floats:
        """Derivatives by c_e and c_i among those by all concentrations (n, 2, M)."""
        assert sol.sides is not None
        out = np.zeros_like(sol.sides.c)
        out[:, FRONT, solute], out[:, BACK, solute] = by_e, by_i
        return out
