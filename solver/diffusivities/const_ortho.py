"""Constant orthotropic diffusivity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import Diffusivity


@dataclass(eq=False)
class ConstOrtho(Diffusivity):
    """D = sum_a diff_a q_a q_a in space, q_a the material axes of the reference; D0 = free_diff.

    FEBio User Manual, "Constant Orthotropic Diffusivity"; FEBio takes the strain tangent as zero.
    """

    free_diff: Number = 1.0
    diff: tuple[Number, ...] = (1.0, 1.0, 1.0)
    parameters = ("free_diff", "diff")
    vectors = {"diff": 3}
    strain_dependent = False

    def free(self, pts: Points, sol: Solution, i: int) -> Floats:
        return self.par(pts)[:, 0]

    def diffusivity(self, pts: Points, sol: Solution, i: int, D: Floats, dD: Floats | None) -> None:
        Q, d = self.axes(pts), self.par(pts)[:, 1:]
        tensor = np.einsum("nia,na,nja->nij", Q, np.broadcast_to(d, (max(len(Q), len(d)), 3)), Q)
        D += tensor[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]


register(ConstOrtho, "diff-const-ortho")
