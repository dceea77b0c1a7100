"""Compressible neo-Hookean solid."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from ..jit import kernel
from ..kernels.tensors import add_identity, left_cauchy_green
from ..points import Points
from ..record import variable_record
from .base import Floats, Number, Solid, wanted
from .lame import lame, shear_and_first
from .registry import register


@kernel
def add_stress(F, J, par, s, c):
    """Add stress and tangent; ``par`` (1|n, 2): E and v."""
    b = np.empty(6)
    for i in range(len(J)):
        m = i if par.shape[0] > 1 else 0
        lam, mu = lame(par[m, 0], par[m, 1])
        left_cauchy_green(F, i, 1.0, b)
        g, p = mu / J[i], lam * math.log(J[i]) / J[i]
        for a in range(3):
            s[i, a] += g * (b[a] - 1.0) + p
            s[i, a + 3] += g * b[a + 3]
        if c.shape[0] > 0:
            add_identity(c, i, lam / J[i], 2.0 * (g - p))


def strain_energy(pts: Points, lam: Floats, mu: Floats) -> Floats:
    """W (n,) of Lame's parameters (1|n,)."""
    lnJ = np.log(pts.J)
    return np.asarray(0.5 * mu * ((pts.F**2).sum((1, 2)) - 3.0 - 2.0 * lnJ) + 0.5 * lam * lnJ**2)


@variable_record
class NeoHookean(Solid):
    """W = mu (I1 - 3 - 2 ln J) / 2 + lambda (ln J)^2 / 2, mu and lambda from E and v.

    Bonet & Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, section 6.4.
    """

    E: Number = 0.0
    v: Number = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("E", "v")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        add_stress(pts.F, pts.J, self.par(pts), s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        return strain_energy(pts, *shear_and_first(self.par(pts)))


@variable_record
class NeoHookeanAD(NeoHookean):
    """The same law, which FEBio differentiates automatically."""


register(NeoHookean, "neo-Hookean")
register(NeoHookeanAD, "neo-Hookean AD")
