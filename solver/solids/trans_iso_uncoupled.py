"""Mooney-Rivlin and Veronda-Westmann solids with one family of fibers, for ligament, tendon and muscle."""

from __future__ import annotations

from dataclasses import field
from typing import Any, ClassVar

import numpy as np

from ..points import Points
from ..record import variable_record
from .base import Floats, Number, Property
from .fiber import directions
from .fiber_exp_linear import add_family, family_energy
from .mooney_rivlin import MooneyRivlin
from .registry import register
from .uncoupled import Uncoupled
from .veronda_westmann import VerondaWestmann


@variable_record
class _WithFibers(Uncoupled):
    """Adds F(l~) of :mod:`.fiber_exp_linear` to the solid that comes next among the bases, of c1 and c2.

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
    parameters: ClassVar[tuple[str, ...]] = ("c1", "c2", "c3", "c4", "c5", "lam_max")
    properties = {
        "fiber": Property("direction", default="vector"),
        "active_contraction": Property("active", optional=True),
    }

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        super().dev(pts, s, c)
        a0 = directions(self.fiber, self.inner(pts))
        add_family(pts, a0, np.ascontiguousarray(self.par(pts)[:, 2:]), s, c)
        if self.active_contraction is not None:
            self.active_contraction.add(pts, a0, s, c)

    def dev_energy(self, pts: Points) -> Floats:
        a0 = directions(self.fiber, self.inner(pts))
        return super().dev_energy(pts) + family_energy(pts, a0, self.par(pts)[:, 2:])


@variable_record
class TransIsoMooneyRivlin(_WithFibers, MooneyRivlin):
    """W~ = c1 (I1~ - 3) + c2 (I2~ - 3) + F(l~)."""


@variable_record
class TransIsoVerondaWestmann(_WithFibers, VerondaWestmann):
    """W~ = c1 (exp[c2 (I1~ - 3)] - 1) - c1 c2 (I2~ - 3) / 2 + F(l~)."""


@variable_record
class TransIsoMooneyRivlinEstrada(TransIsoMooneyRivlin):
    """The same, whose muscle may also shorten by a force-velocity relation."""


register(TransIsoMooneyRivlin, "trans iso Mooney-Rivlin")
register(TransIsoVerondaWestmann, "trans iso Veronda-Westmann")
register(TransIsoMooneyRivlinEstrada, "trans iso MR-Estrada")
