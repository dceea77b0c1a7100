"""Active tension of muscle fibers by a time-varying elastance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..kernels.fibers import add_fibers, squared_stretch
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .fiber import directions
from .registry import register
from .uncoupled import Uncoupled
from .voigt import vector


def tension(Tmax: Floats, ratio2: Floats, beta: Floats, dl: Floats) -> tuple[Floats, Floats]:
    """T = Tmax x / (x + ratio2), x = exp(beta dl) - 1, for dl >= 0, and dT/d(dl)."""
    on = dl >= 0
    e = np.exp(beta * np.where(on, dl, 0.0))
    d = e - 1.0 + ratio2
    with np.errstate(invalid="ignore"):  # 0 / 0 where ratio2 is 0 and dl, too
        T, dT = Tmax * (e - 1.0) / d, Tmax * beta * e * ratio2 / d**2
    return np.where(on, T, 0.0), np.where(on, dT, 0.0)


@dataclass(eq=False)
class ActiveContraction(Solid):
    """sigma = T a dyad a, T = Tmax ascl x / (x + (camax/ca0)^2), x = exp[beta (refl l~ - l0)] - 1.

    Guccione & McCulloch, J. Biomech. Eng. 115 (1993) 72. Where camax is 0, ca0 takes its place.
    """

    consistent = False
    ascl: Number = 0.0
    Tmax: Number = 1.0
    ca0: Number = 1.0
    camax: Number = 0.0
    beta: Number = 0.0
    l0: Number = 0.0
    refl: Number = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("ascl", "Tmax", "ca0", "camax", "beta", "l0", "refl")

    def add(self, pts: Points, a0: Floats, s: Floats, c: Floats | None) -> None:
        """Add the active stress along ``a0`` (1|n, 3)."""
        ascl, Tmax, ca0, camax, beta, l0, refl = self.par(pts).T[:7, :, None]
        In = np.empty((pts.n, 1))
        squared_stretch(pts.F, pts.J, a0[:, None], False, In)
        J = pts.J[:, None]
        stretch = np.sqrt(In) * J ** (-1.0 / 3.0)
        ratio2 = (np.where(camax == 0, ca0, camax) / ca0) ** 2
        T, dT = tension(Tmax * np.maximum(ascl, 0.0), ratio2, beta, refl * stretch - l0)
        dT = refl * dT
        cn = J * (stretch * dT - 2.0 * T)
        add_fibers(
            pts.F, pts.J, a0[:, None], np.ones((1, 1)), In, J * T, cn, np.empty((0, 0)), False, s, wanted(c)
        )


@dataclass(eq=False)
class ForceVelocity(ActiveContraction):
    """The same tension: what it should lose as the fiber shortens is none in FEBio 4.11, whose stretch before a step is
    that of its last iteration. Estrada et al., J. Biomech. Eng. 141 (2019) 101007."""

    alpha1: Number = 0.0
    alpha2: Number = 0.0
    alpha3: Number = 0.0
    A1: Number = 0.0
    A2: Number = 0.0
    A3: Number = 0.0
    a_t: Number = 0.0
    force_velocity: int = 1
    parameters = (*ActiveContraction.parameters, "alpha1", "alpha2", "alpha3", "A1", "A2", "A3", "a_t")
    options = ("force_velocity",)


@dataclass(eq=False)
class UncoupledActiveContraction(Uncoupled):
    """sigma = T n dyad n along the first material axis, n = F e1 / l; with a trace, without a tangent, as in FEBio."""

    consistent = False
    Tmax: Number = 0.0
    ca0: Number = 1.0
    camax: Number = 0.0
    beta: Number = 0.0
    l0: Number = 0.0
    refl: Number = 0.0
    parameters = ("Tmax", "ca0", "camax", "beta", "l0", "refl")

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        Tmax, ca0, camax, beta, l0, refl = self.par(pts).T
        n = np.einsum("nij,nj->ni", pts.F, np.broadcast_to(directions(None, self.inner(pts)), (pts.n, 3)))
        l = np.linalg.norm(n, axis=1)
        T, _ = tension(Tmax, (camax / ca0) ** 2, beta, refl * l * pts.J ** (-1.0 / 3.0) - l0)
        s += vector((T / l**2)[:, None, None] * n[:, :, None] * n[:, None, :])


register(UncoupledActiveContraction, "uncoupled active contraction")
register(ActiveContraction, "active_contraction", "active")
register(ActiveContraction, "uncoupled active_contraction", "active")
register(ForceVelocity, "force-velocity-Estrada", "active")
