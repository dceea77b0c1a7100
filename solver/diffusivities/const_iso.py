"""Constant isotropic diffusivity."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import Diffusivity


@dataclass(eq=False)
class ConstIso(Diffusivity):
    """D = diff I in space, D0 = free_diff. FEBio User Manual, "Constant Isotropic Diffusivity".

    FEBio takes the strain tangent as zero: in its convention that is D convected with the solid, not D held in space.
    """

    free_diff: Number = 1.0
    diff: Number = 1.0
    parameters = ("free_diff", "diff")
    strain_dependent = False

    def free(self, pts: Points, sol: Solution, i: int) -> Floats:
        return self.par(pts)[:, 0]

    def diffusivity(self, pts: Points, sol: Solution, i: int, D: Floats, dD: Floats | None) -> None:
        D[:, :3] += self.par(pts)[:, 1:]


register(ConstIso, "diff-const-iso")
