"""Veronda-Westmann solid with one family of fibers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..points import Points
from .base import Floats, Number, Property, wanted
from .fiber import directions
from .fiber_exp_linear import add_family, family_energy
from .invariants import isochoric_invariants
from .registry import register
from .uncoupled import Uncoupled
from .veronda_westmann import run


@dataclass(eq=False)
class TransIsoVerondaWestmann(Uncoupled):
    """W~ of :mod:`.veronda_westmann` plus fibers of :mod:`.fiber_exp_linear`."""

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
        matrix = par[:, 0] * np.expm1(par[:, 1] * (I1 - 3)) - 0.5 * par[:, 0] * par[:, 1] * (I2 - 3)
        return matrix + family_energy(pts, a0, par[:, 2:])


register(TransIsoVerondaWestmann, "trans iso Veronda-Westmann")
