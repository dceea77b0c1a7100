"""Partition coefficients of solutes and their derivatives.

kappa_i = k_i zeta^z_i, zeta from electroneutrality. With S = sum z_i^2 kappa_i c_i,
dln zeta/dJ = -(dcF/dJ + sum z_i zeta^z_i c_i dk_i/dJ) / S, and so on: FEBio Theory Manual, "Multiphasic materials".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.partition import slopes
from ..law import Floats
from ..points import Points
from .electroneutrality import potential
from .material import Mixture
from .solution import Solution


@dataclass(slots=True)
class Potential:
    """y = ln zeta (n,), its derivatives by J (n,) and c (n, m), and 1 / S (n,), 0 where S is not positive."""

    y: Floats
    by_J: Floats
    by_c: Floats
    S: Floats
    zz: Floats  # zeta^z (n, m)
    by_J_k: Floats  # dk/dJ (n, m)
    by_c_k: Floats  # dk_i/dc_j (n|0, m, m), without rows where all are 0


def solubilities(mix: Mixture, pts: Points, sol: Solution) -> Floats:
    """k (n, m)."""
    out = np.empty_like(sol.c)
    for i, s in enumerate(mix.solutes):
        out[:, i] = s.solubility.solubility(pts, sol, i)
    return out


def partition(mix: Mixture, pts: Points, sol: Solution, y: Floats) -> Potential:
    """Set kappa, ca and derivatives of ``sol``; y (n,) is the last ln zeta, renewed in place.

    Solutes that do not diffuse take no part in the balance of charge but through cF.
    """
    k, z = solubilities(mix, pts, sol), mix.z
    y[:] = potential(z, np.where(sol.fixed, 0.0, k * sol.c), sol.cF, y)
    sol.kappa[:] = k * _powers(z, y, sol)
    sol.ca[:] = sol.kappa * sol.c
    return _slopes(mix, pts, sol, y, sol.dkdJ, sol.dkdc)


def zeta_slopes(mix: Mixture, pts: Points, sol: Solution, y: Floats) -> Potential:
    """The derivatives of ln zeta = y (n,), by which ``sol`` is partitioned."""
    return _slopes(mix, pts, sol, y, np.empty_like(sol.dkdJ), np.empty_like(sol.dkdc))


def _slopes(mix: Mixture, pts: Points, sol: Solution, y: Floats, dkdJ: Floats, dkdc: Floats) -> Potential:
    """Those derivatives; dkdJ and dkdc are set."""
    n, m = sol.c.shape
    dkJ, dkc = _solubility_slopes(mix, pts, sol)
    p = Potential(y, np.empty(n), np.empty((n, m)), np.empty(n), _powers(mix.z, y, sol), dkJ, dkc)
    slopes(mix.z, pts.J - sol.phi0, sol.c, sol.cF, sol.kappa, p.zz, dkJ, dkc, p.by_J, p.by_c, p.S, dkdJ, dkdc)
    return p


def _powers(z: Floats, y: Floats, sol: Solution) -> Floats:
    """zeta^z (n, m)."""
    return np.exp(z * y[:, None]) if z.any() else np.ones_like(sol.c)


def _solubility_slopes(mix: Mixture, pts: Points, sol: Solution) -> tuple[Floats, Floats]:
    """Derivatives of the solubilities by J (n, m) and c (n|0, m, m), without rows where none varies."""
    n, m = sol.c.shape
    dJ, dc = np.zeros((n, m)), np.zeros((0, m, m))
    for i, s in enumerate(mix.solutes):
        given = s.solubility.slopes(pts, sol, i)
        if given is not None:
            dc = dc if len(dc) else np.zeros((n, m, m))
            dJ[:, i], dc[:, i] = given
    return dJ, dc


@dataclass(slots=True)
class ByBound:
    """Derivatives of kappa by the densities of solid-bound molecules: r (n, m, b), Jr (n, m, b), rc (n, m, b, m)."""

    r: Floats
    Jr: Floats
    rc: Floats


def by_bound(p: Potential, pts: Points, sol: Solution) -> ByBound:
    """First derivatives of kappa by referential densities, and mixed ones with J and c."""
    z, free, cF = sol.z, pts.J - sol.phi0, sol.cF
    by_c_k = p.by_c_k if len(p.by_c_k) else np.zeros_like(sol.dkdc)
    zc2 = z * z * sol.c
    third = (z * zc2 * sol.kappa).sum(axis=1) * p.S
    # dln zeta / d rho_b
    y_r = -(cF[:, None] / sol.bound_density + sol.bound_charge / sol.molar) / free[:, None] * p.S[:, None]
    y_Jr = y_r * (1.0 / free + (zc2 * sol.dkdJ).sum(axis=1) * p.S + p.by_J)[:, None]
    y_Jr += (cF / free**2 * p.S)[:, None] / sol.bound_density
    own = z * z * sol.kappa + np.einsum("nj,nji->ni", zc2 * p.zz, by_c_k)
    y_rc = y_r[:, :, None] * (p.by_c * (1.0 + third[:, None]) - own * p.S[:, None])[:, None, :]
    k = sol.kappa
    r = (z * k)[:, :, None] * y_r[:, None, :]
    slope = z * (p.by_J_k * p.zz + (z - 1.0) * k * p.by_J[:, None])
    Jr = slope[:, :, None] * y_r[:, None, :] + (z * k)[:, :, None] * y_Jr[:, None, :]
    mixed = z[:, None] * (p.zz[:, :, None] * by_c_k + ((z - 1.0) * k)[:, :, None] * p.by_c[:, None, :])
    rc = mixed[:, :, None, :] * y_r[:, None, :, None] + (z * k)[:, :, None, None] * y_rc[:, None, :, :]
    return ByBound(r, Jr, rc)
