"""Fluxes of fluid and solutes at points.

w = -Ke (grad p + R T sum_i kappa_i D_i grad c_i / D0_i),
Ke^-1 = K^-1 + R T / phi sum_i kappa_i c_i (I - D_i / D0_i) / D0_i,
j_i = kappa_i D_i (c_i w / D0_i - phi grad c_i), by effective pressure p and effective concentrations c.
Ateshian, Biomech. Model. Mechanobiol. 6 (2007) 423; FEBio Theory Manual, "Multiphasic materials".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..law import Floats
from ..permeabilities.base import open_pores
from ..points import Points
from .material import Mixture
from .solution import Solution
from .voigt import full

_EYE = np.eye(3)


@dataclass(slots=True)
class Flow:
    """phi (n,) porosity; Ki inverse permeability, Ke effective permeability (n, 3, 3); D (n, m, 3, 3), D0 (n, m);
    Dgc (n, m, 3) = D grad c; gp (n, 3) effective driving gradient; w (n, 3), j (n, m, 3) fluxes."""

    phi: Floats
    Ki: Floats
    Ke: Floats
    D: Floats
    D0: Floats
    Dgc: Floats
    gp: Floats
    w: Floats
    j: Floats


def diffusivities(mix: Mixture, pts: Points, sol: Solution) -> tuple[Floats, Floats]:
    """D (n, m, 3, 3) and D0 (n, m)."""
    n, m = sol.c.shape
    D, D0 = np.zeros((m, n, 6)), np.empty((n, m))
    for i, s in enumerate(mix.solutes):
        s.diffusivity.diffusivity(pts, sol, i, D[i], None)
        D0[:, i] = s.diffusivity.free(pts, sol, i)
    return full(D).transpose(1, 0, 2, 3), D0


def permeability(mix: Mixture, pts: Points, sol: Solution, tangent: bool = False) -> tuple[Floats, Floats | None]:
    """Hydraulic permeability (n, 3, 3), and its strain tangent (n, 6, 6) where asked for and not zero."""
    k = np.zeros((pts.n, 6))
    dk = np.zeros((pts.n, 6, 6)) if tangent and mix.permeability.strain_dependent else None
    mix.permeability.permeability(pts, sol.phi0, k, dk)
    return full(k), dk


def flow(mix: Mixture, pts: Points, sol: Solution, gp: Floats, gc: Floats) -> Flow:
    """Fluxes for gradients gp (n, 3) of effective pressure and gc (n, m, 3) of effective concentrations."""
    open_pores(pts, sol.phi0)
    phi: Floats = 1.0 - sol.phi0 / pts.J
    Ki = np.asarray(np.linalg.inv(permeability(mix, pts, sol)[0]), dtype=np.float64)
    D, D0 = diffusivities(mix, pts, sol)
    drag = sol.ca / D0
    friction = _EYE * drag.sum(axis=1)[:, None, None] - np.einsum("ni,niab->nab", drag / D0, D)
    Ke = np.linalg.inv(Ki + (mix.RT / phi)[:, None, None] * friction)
    Dgc = np.einsum("niab,nib->nia", D, gc)
    drive = gp + mix.RT * np.einsum("ni,nia->na", sol.kappa / D0, Dgc)
    w = -np.einsum("nab,nb->na", Ke, drive)
    Dw = np.einsum("niab,nb->nia", D, w)
    j = sol.ca[:, :, None] / D0[:, :, None] * Dw - (sol.kappa * phi[:, None])[:, :, None] * Dgc
    return Flow(phi, Ki, Ke, D, D0, Dgc, drive, w, j)
