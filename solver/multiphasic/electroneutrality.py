"""The electric potential that keeps the interstitial fluid neutral.

sum_i z_i k_i c_i zeta^z_i + cF = 0 for zeta = exp(-Fc psi / (R T)): the left side grows with zeta, so that the
positive root, where there is one, is the only one. Huyghe & Janssen, Int. J. Engng Sci. 35 (1997) 793;
FEBio Theory Manual, "Triphasic materials", "Multiphasic materials".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernels import partition as kernels

Floats = NDArray[np.float64]


def potential(z: Floats, kc: Floats, cF: Floats, guess: Floats) -> Floats:
    """ln zeta (n,) for charge numbers z (m,), concentrations kc (n, m), charge density cF (n,), from a guess (n,).

    0 where no solute is charged, and where ions of the sign that the fixed charge asks for are missing.
    """
    y = guess.copy()
    kernels.potential(z, kc, cF, y)
    return y
