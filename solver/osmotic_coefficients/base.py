"""What an osmotic coefficient is."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Law
from ..multiphasic.solution import Solution
from ..points import Points


@dataclass(eq=False)
class OsmoticCoefficient(Law):
    """Phi in the actual pressure p = p_effective + R T Phi sum of actual concentrations.

    ``coefficient`` gives it (1|n,); ``slopes`` its derivatives by J (n,) and by effective concentrations (n, m), or
    None where it is constant.
    """

    def coefficient(self, pts: Points, sol: Solution) -> Floats:
        raise NotImplementedError

    def slopes(self, pts: Points, sol: Solution) -> tuple[Floats, Floats] | None:
        return None
