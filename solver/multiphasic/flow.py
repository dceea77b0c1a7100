"""Fluxes of fluid and solutes at points.

w = -Ke (grad p + R T sum_i kappa_i D_i grad c_i / D0_i),
Ke^-1 = K^-1 + R T / phi sum_i kappa_i c_i (I - D_i / D0_i) / D0_i,
j_i = kappa_i D_i (c_i w / D0_i - phi grad c_i), by effective pressure p and effective concentrations c.
Ateshian, Biomech. Model. Mechanobiol. 6 (2007) 423; FEBio Theory Manual, "Multiphasic materials".
"""

from __future__ import annotations

import numpy as np

from ..law import Floats
from ..points import Points
from .material import Mixture
from .solution import Solution


def diffusivities(mix: Mixture, pts: Points, sol: Solution) -> tuple[Floats, Floats]:
    """D (n, m, 6) and D0 (n, m)."""
    n, m = sol.c.shape
    D, D0 = np.zeros((m, n, 6)), np.empty((n, m))
    for i, s in enumerate(mix.solutes):
        s.diffusivity.diffusivity(pts, sol, i, D[i], None)
        D0[:, i] = s.diffusivity.free(pts, sol, i)
    return D.transpose(1, 0, 2), D0


def permeability(mix: Mixture, pts: Points, sol: Solution) -> Floats:
    """Hydraulic permeability (n, 6)."""
    k = np.zeros((pts.n, 6))
    mix.permeability.permeability(pts, sol.phi0, k, None)
    return k


def strain_tangents(mix: Mixture, pts: Points, sol: Solution) -> tuple[Floats, Floats]:
    """Those of the permeability (n|0, 6, 6) and of the diffusivities (n|0, m, 6, 6), without rows where they vanish."""
    n, m = sol.c.shape
    dK, dD = np.zeros((n, 6, 6)), np.zeros((n, m, 6, 6))
    strained = [i for i, s in enumerate(mix.solutes) if s.diffusivity.strain_dependent]
    for i in strained:
        d = np.zeros((n, 6, 6))
        mix.solutes[i].diffusivity.diffusivity(pts, sol, i, np.zeros((n, 6)), d)
        dD[:, i] = d
    if mix.permeability.strain_dependent:
        mix.permeability.permeability(pts, sol.phi0, np.zeros((n, 6)), dK)
    return dK if mix.permeability.strain_dependent else dK[:0], dD if strained else dD[:0]


def slopes(mix: Mixture, pts: Points, sol: Solution) -> tuple[Floats, Floats]:
    """Slopes by concentrations of the diffusivities (n|0, m, m, 6), without rows where none varies, and of those in
    free solution (n, m, m)."""
    n, m = sol.c.shape
    D, D0 = np.zeros((0, m, m, 6)), np.zeros((n, m, m))
    for i, s in enumerate(mix.solutes):
        given = s.diffusivity.slopes(pts, sol, i)
        if given is not None:
            D = D if len(D) else np.zeros((n, m, m, 6))
            D[:, i], D0[:, i] = given
    return D, D0
