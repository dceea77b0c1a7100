"""Synthesis of the solute beside receptors that bind it."""

from __future__ import annotations

from dataclasses import dataclass

from ..law import Floats, Number
from ..points import Points
from . import register
from .binding import Binding


@dataclass(eq=False)
class SynthesisBinding(Binding):
    """crhat = supp - (kf cr (Rtot - bound) - kr bound). FEBio User Manual, "Supply synthesis binding"."""

    supp: Number = 0.0
    parameters = ("kf", "kr", "Rtot", "supp")

    def supply(self, pts: Points, cr: Floats, bound: Floats) -> Floats:
        return self.par(pts)[:, 3] + super().supply(pts, cr, bound)


register(SynthesisBinding, "supply-synthesis-binding")
