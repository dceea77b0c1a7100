"""Neo-Hookean solid of a porous medium whose pores close at a finite relative volume."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..jit import kernel
from ..kernels.tensors import add_dyad_identity, add_identity, left_cauchy_green, trace
from ..points import Points
from .base import Floats, Number, Solid, wanted
from .registry import register


@kernel
def _run(F, J, par, s, c):
    b = np.empty(6)
    for i in range(len(J)):
        m = i if par.shape[0] > 1 else 0
        E, phi = par[m, 0], par[m, 1]
        mu1 = E / 3.0 * (1.0 + 0.5 * (1.0 - phi) ** 2) / J[i]
        R = ((J[i] - phi) / (1.0 - phi) / J[i]) ** (2.0 / 3.0)
        left_cauchy_green(F, i, 1.0, b)
        I1 = trace(b)
        gap = J[i] - phi
        p = mu1 * (phi * R * I1 / 3.0 - J[i]) / gap
        for a in range(3):
            s[i, a] += mu1 * R * b[a] + p
            s[i, a + 3] += mu1 * R * b[a + 3]
        if c.shape[0] > 0:
            g = mu1 * R * phi / gap
            dg = mu1 * R * (2.0 * phi - 3.0 * J[i]) * phi / 3.0 / gap**2
            dh = J[i] * mu1 * phi / gap**2
            add_dyad_identity(c, i, 2.0 / 3.0 * g, b)
            add_identity(c, i, dg * I1 / 3.0 + dh, -2.0 * (g * I1 / 3.0 - mu1 * J[i] / gap))


@dataclass(eq=False)
class PorousNeoHookean(Solid):
    """W = mu (I1 (Jbar/J)^(2/3) - 3 - 2 ln Jbar) / 2, Jbar = (J - phi0) / (1 - phi0).

    mu = E (1 + (1 - phi0)^2 / 2) / 3. Within a biphasic material phi0 is the mixture's (the caller sets
    it). FEBio Theory Manual, section "Porous neo-Hookean material".
    """

    E: Number = 0.0
    phi0: Number = 1.0
    parameters = ("E", "phi0")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        _run(pts.F, pts.J, self.par(pts), s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        E, phi = self.par(pts).T
        mu = E / 3.0 * (1.0 + 0.5 * (1.0 - phi) ** 2)
        Jbar = (pts.J - phi) / (1.0 - phi)
        I1 = (pts.F**2).sum((1, 2)) * (Jbar / pts.J) ** (2.0 / 3.0)
        return mu * (0.5 * (I1 - 3.0) - np.log(Jbar))


register(PorousNeoHookean, "porous neo-Hookean")
