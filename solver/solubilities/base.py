"""What a solubility is."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Law
from ..multiphasic.solution import Solution
from ..points import Points


@dataclass(eq=False)
class Solubility(Law):
    """Fraction of the pore space open to solute i, over its activity coefficient.

    ``solubility`` gives it (1|n,); ``slopes`` its derivatives by J (n,) and by effective concentrations (n, m), or
    None where it is constant. A law that asks for actual concentrations is given those of the last evaluation.
    """

    def solubility(self, pts: Points, sol: Solution, i: int) -> Floats:
        raise NotImplementedError

    def slopes(self, pts: Points, sol: Solution, i: int) -> tuple[Floats, Floats] | None:
        return None
