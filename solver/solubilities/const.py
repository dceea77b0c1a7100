"""Constant solubility."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..points import Points
from . import register
from .base import Solubility


@dataclass(eq=False)
class Const(Solubility):
    """kappa_hat = solub. FEBio User Manual, "Constant Solubility"."""

    solub: Number = 1.0
    parameters = ("solub",)

    def solubility(self, pts: Points, sol: Solution, i: int) -> Floats:
        return self.par(pts)[:, 0]


register(Const, "solub-const")
