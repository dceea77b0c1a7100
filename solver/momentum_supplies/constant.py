"""A momentum supply of constant size along a material axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats, Law, Number
from ..points import Points
from . import register


@dataclass(eq=False)
class Constant(Law):
    """A force ``supply`` F a per volume drives the fluid, a the first material axis.

    Its change with F is left out of the tangent, as in FEBio.
    """

    supply: Number = 0.0
    parameters = ("supply",)

    def drive(self, pts: Points) -> Floats:
        """(n, 3)."""
        a = np.broadcast_to(self.axes(pts)[:, :, 0], (pts.n, 3))
        return np.asarray(self.par(pts) * np.einsum("nij,nj->ni", pts.F, a))


register(Constant, "active-const-supply")
