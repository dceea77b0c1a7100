"""The electric potential that keeps the interstitial fluid neutral.

sum_i z_i k_i c_i zeta^z_i + cF = 0 for zeta = exp(-Fc psi / (R T)): the left side grows with zeta, so that the
positive root, where there is one, is the only one. Huyghe & Janssen, Int. J. Engng Sci. 35 (1997) 793;
FEBio Theory Manual, "Triphasic materials", "Multiphasic materials".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
MOST, LONGEST = 100, 2.0


def potential(z: Floats, kc: Floats, cF: Floats, guess: Floats) -> Floats:
    """ln zeta (n,) for charge numbers z (m,), concentrations kc (n, m), charge density cF (n,), from a guess (n,).

    0 where no solute is charged, and where ions of the sign that the fixed charge asks for are missing.
    """
    if not z.any():
        return np.zeros(len(cF))
    if set(np.unique(z)) <= {-1.0, 0.0, 1.0}:
        return _monovalent(kc[:, z > 0].sum(axis=1), kc[:, z < 0].sum(axis=1), cF)
    return _general(z[z != 0.0], kc[:, z != 0.0], cF, guess)


def _monovalent(cations: Floats, anions: Floats, cF: Floats) -> Floats:
    """The positive root of cations zeta^2 + cF zeta - anions = 0, without cancellation."""
    root = np.sqrt(cF * cF + 4.0 * cations * anions)
    over = np.where(cF > 0.0, 2.0 * anions, root - cF)
    under = np.where(cF > 0.0, cF + root, 2.0 * cations)
    good = (over > 0.0) & (under > 0.0)
    return np.where(good, np.log(np.where(good, over, 1.0) / np.where(good, under, 1.0)), 0.0)


def _general(z: Floats, kc: Floats, cF: Floats, guess: Floats) -> Floats:
    """Newton's method for y = ln zeta, with steps of bounded length."""
    y = np.where(np.isfinite(guess), guess, 0.0)
    possible = (np.where(z > 0, kc, 0.0).any(axis=1) | (cF > 0.0)) & (np.where(z < 0, kc, 0.0).any(axis=1) | (cF < 0.0))
    for _ in range(MOST):
        terms = z * kc * np.exp(z * y[:, None])
        slope = terms @ z
        step = -(terms.sum(axis=1) + cF) / np.where(slope > 0.0, slope, 1.0)
        step = np.where(possible, np.clip(step, -LONGEST, LONGEST), 0.0)
        y = y + step
        if np.max(np.abs(step), initial=0.0) < 1e-13:
            break
    return np.where(possible, y, 0.0)
