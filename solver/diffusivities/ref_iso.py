"""Referentially isotropic diffusivity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.permeability import referential
from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..permeabilities.base import open_pores, wanted
from ..points import Points
from . import register
from .base import Diffusivity

_IDENTITY = np.eye(3)[None]


@dataclass(eq=False)
class RefIso(Diffusivity):
    """D = f (diff0 I + diff1 b / J^2 + diff2 b^2 / J^4), f = ((J - phi0) / (1 - phi0))^alpha exp(M (J^2 - 1) / 2).

    D0 = diff0 whatever ``free_diff`` says, as in FEBio 4.11. Ateshian & Weiss, J. Biomech. Eng. 132 (2010) 111004.
    """

    free_diff: Number = 1.0
    diff0: Number = 1.0
    diff1: Number = 0.0
    diff2: Number = 0.0
    M: Number = 0.0
    alpha: Number = 0.0
    parameters = ("free_diff", "diff0", "diff1", "diff2", "M", "alpha")

    def free(self, pts: Points, sol: Solution, i: int) -> Floats:
        return self.par(pts)[:, 1]

    def diffusivity(self, pts: Points, sol: Solution, i: int, D: Floats, dD: Floats | None) -> None:
        par = self.par(pts)
        if par[:, 5].any():
            open_pores(pts, sol.phi0)
        columns = [1, 4, 5, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5]
        referential(pts.F, pts.J, sol.phi0, _IDENTITY, np.ascontiguousarray(par[:, columns]), D, wanted(dD))


register(RefIso, "diff-ref-iso")
