"""Isotropic diffusivity that falls with the solute's concentration and as the pores close."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..permeabilities.base import open_pores
from ..points import Points
from . import register
from .base import Diffusivity


@dataclass(eq=False)
class AlbroIso(Diffusivity):
    """D = free_diff exp(-alphad phi_s / phi_w - cdinv ca) I, D0 = free_diff exp(-cdinv ca).

    phi_s / phi_w = phi0 / (J - phi0); ca is the solute's actual concentration.
    Albro, Rajan, Li, Hung, Ateshian, Cell. Mol. Bioeng. 2 (2009) 295.
    """

    free_diff: Number = 1.0
    cdinv: Number = 0.0
    alphad: Number = 0.0
    parameters = ("free_diff", "cdinv", "alphad")

    def free(self, pts: Points, sol: Solution, i: int) -> Floats:
        d0, cdinv, _ = self.par(pts).T
        return d0 * np.exp(-cdinv * sol.ca[:, i])

    def _hindered(self, pts: Points, sol: Solution, i: int) -> Floats:
        open_pores(pts, sol.phi0)
        return self.free(pts, sol, i) * np.exp(-self.par(pts)[:, 2] * sol.phi0 / (pts.J - sol.phi0))

    def diffusivity(self, pts: Points, sol: Solution, i: int, D: Floats, dD: Floats | None) -> None:
        d, J, phi0 = self._hindered(pts, sol, i), pts.J, sol.phi0
        D[:, :3] += d[:, None]
        if dD is None:
            return
        _, cdinv, alphad = self.par(pts).T
        dJ = d * (1.0 + J * (alphad * phi0 / (J - phi0) ** 2 - cdinv * sol.c[:, i] * sol.dkdJ[:, i]))
        dD[:, :3, :3] += dJ[:, None, None]
        dD[:, range(3), range(3)] -= 2.0 * d[:, None]
        dD[:, range(3, 6), range(3, 6)] -= d[:, None]

    def slopes(self, pts: Points, sol: Solution, i: int) -> tuple[Floats, Floats]:
        by_c = -self.par(pts)[:, 1:2] * sol.by_concentration(i)
        dD = np.zeros((*by_c.shape, 6))
        dD[..., :3] = (self._hindered(pts, sol, i)[:, None] * by_c)[..., None]
        return dD, self.free(pts, sol, i)[:, None] * by_c


register(AlbroIso, "diff-Albro-iso")
