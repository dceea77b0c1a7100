"""Active tension of muscle fibers by a time-varying elastance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.fibers import add_fibers, squared_stretch
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .registry import register


@dataclass(eq=False)
class ActiveContraction(Solid):
    """sigma = T a dyad a, T = Tmax ascl x / (x + (camax/ca0)^2), x = exp[beta (refl l~ - l0)] - 1.

    Guccione & McCulloch, J. Biomech. Eng. 115 (1993) 72. Where camax is 0, ca0 takes its place.
    """

    ascl: Number = 0.0
    Tmax: Number = 1.0
    ca0: Number = 1.0
    camax: Number = 0.0
    beta: Number = 0.0
    l0: Number = 0.0
    refl: Number = 0.0
    parameters = ("ascl", "Tmax", "ca0", "camax", "beta", "l0", "refl")

    def add(self, pts: Points, a0: Floats, s: Floats, c: Floats | None) -> None:
        """Add the active stress along ``a0`` (1|n, 3)."""
        ascl, Tmax, ca0, camax, beta, l0, refl = self.par(pts).T[:, :, None]
        In = np.empty((pts.n, 1))
        squared_stretch(pts.F, pts.J, a0[:, None], False, In)
        J = pts.J[:, None]
        stretch = np.sqrt(In) * J ** (-1.0 / 3.0)
        dl = refl * stretch - l0
        on = (dl >= 0) & (ascl > 0)
        e = np.exp(beta * np.where(on, dl, 0.0))
        ratio2 = (np.where(camax == 0, ca0, camax) / ca0) ** 2
        d = e - 1.0 + ratio2
        T = np.where(on, Tmax * ascl * (e - 1.0) / d, 0.0)
        dT = np.where(on, Tmax * ascl * beta * refl * e * ratio2 / d**2, 0.0)
        cn = J * (stretch * dT - 2.0 * T)
        add_fibers(
            pts.F, pts.J, a0[:, None], np.ones((1, 1)), In, J * T, cn, np.empty((0, 0)), False, s, wanted(c)
        )


register(ActiveContraction, "active_contraction", "active")
register(ActiveContraction, "uncoupled active_contraction", "active")
