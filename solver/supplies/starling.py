"""Starling's law of filtration through capillary walls."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..points import Points
from . import register
from .base import Supply


@dataclass(eq=False)
class Starling(Supply):
    """q = kp (pv - p). FEBio User Manual, "Starling Equation"."""

    kp: Number = 0.0
    pv: Number = 0.0
    parameters = ("kp", "pv")

    def supply(self, pts: Points, p: Floats, q: Floats, dE: Floats | None, dp: Floats | None) -> None:
        kp, pv = self.par(pts).T
        q += kp * (pv - p)
        if dp is not None:
            dp -= kp


register(Starling, "Starling")
