"""Mooney-Rivlin solid with one family of fibers, for ligament, tendon and muscle."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..points import Points
from .base import Floats, Number, Property, wanted
from .fiber import directions
from .fiber_exp_linear import add_family, family_energy
from .invariants import isochoric_invariants
from .mooney_rivlin import run
from .registry import register
from .uncoupled import Uncoupled


@dataclass(eq=False)
class TransIsoMooneyRivlin(Uncoupled):
    """W~ = c1 (I1~ - 3) + c2 (I2~ - 3) + F(l~), with the fiber law of :mod:`.fiber_exp_linear`.

    Weiss, Maker & Govindjee, Comput. Methods Appl. Mech. Eng. 135 (1996) 107. ``active_contraction`` adds
    an active tension along the fiber.
    """

    c1: Number = 0.0
    c2: Number = 0.0
    c3: Number = 0.0
    c4: Number = 0.0
    c5: Number = 0.0
    lam_max: Number = 1.0
    fiber: Any = field(default=None, kw_only=True)
    active_contraction: Any = field(default=None, kw_only=True)
    parameters = ("c1", "c2", "c3", "c4", "c5", "lam_max")
    properties = {
        "fiber": Property("direction", default="vector"),
        "active_contraction": Property("active", optional=True),
    }

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        par = self.par(pts)
        a0 = directions(self.fiber, self.inner(pts))
        run(pts.F, pts.J, par, s, wanted(c))
        add_family(pts, a0, np.ascontiguousarray(par[:, 2:]), s, c)
        if self.active_contraction is not None:
            self.active_contraction.add(pts, a0, s, c)

    def dev_energy(self, pts: Points) -> Floats:
        I1, I2 = isochoric_invariants(pts)
        par = self.par(pts)
        a0 = directions(self.fiber, self.inner(pts))
        return par[:, 0] * (I1 - 3) + par[:, 1] * (I2 - 3) + family_energy(pts, a0, par[:, 2:])


register(TransIsoMooneyRivlin, "trans iso Mooney-Rivlin")
