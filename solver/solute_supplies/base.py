"""What a supply of a solute is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats, Law
from ..points import Points


@dataclass(eq=False)
class SoluteSupply(Law):
    """Moles of the solute of a biphasic-solute material made per referential volume and time, and what binds it.

    cr (n,): moles of solute per referential volume; bound (n,): moles of the complex it forms with receptors.
    ``supply`` makes solute, ``binding`` makes complex (d bound / dt), ``bound_at_rest`` is the complex's amount in
    a steady state.
    """

    def supply(self, pts: Points, cr: Floats, bound: Floats) -> Floats:
        raise NotImplementedError

    def binding(self, pts: Points, cr: Floats, bound: Floats) -> Floats:
        return np.zeros(pts.n)

    def bound_at_rest(self, pts: Points, cr: Floats) -> Floats:
        return np.zeros(pts.n)
