"""What a diffusivity is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ..law import Floats, Law
from ..multiphasic.solution import Solution
from ..points import Points


@dataclass(eq=False)
class Diffusivity(Law):
    """Spatial diffusivity D of solute i in the mixture, and its diffusivity D0 in free solution (length^2 / time).

    ``diffusivity(pts, sol, i, D, dD)`` *adds* D to ``D`` (n, 6) and, unless ``dD`` is None, the strain tangent that
    FEBio takes for it to ``dD`` (n, 6, 6), defined as for :class:`..permeabilities.base.Permeability`. ``free``
    gives D0 (1|n,). ``slopes`` gives dD/dc_j (n, m, 6) and dD0/dc_j (n, m), or None where neither varies.
    ``strain_dependent`` is False where FEBio leaves the strain tangent out.
    """

    strain_dependent: ClassVar[bool] = True

    def free(self, pts: Points, sol: Solution, i: int) -> Floats:
        raise NotImplementedError

    def diffusivity(self, pts: Points, sol: Solution, i: int, D: Floats, dD: Floats | None) -> None:
        raise NotImplementedError

    def slopes(self, pts: Points, sol: Solution, i: int) -> tuple[Floats, Floats] | None:
        return None
