"""Manning's counterion condensation: activity and osmotic coefficients by charge over co-ion concentration.

X = |cF| / ca, ca the co-ion's actual concentration, with derivatives by J and by effective concentrations at
|cF| (J - phi0) held. Manning, J. Chem. Phys. 51 (1969) 924.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..law import Floats
from ..points import Points
from .solution import Solution


class Function(Protocol):
    """A function of one number and its slope, over arrays."""

    def value(self, x: Floats) -> Floats: ...

    def slope(self, x: Floats) -> Floats: ...


@dataclass(slots=True)
class Ratio:
    """X (n,) and its derivatives by J (n,) and c (n, m); ca (n,) of the co-ion."""

    X: Floats
    by_J: Floats
    by_c: Floats
    ca: Floats


def ratio(pts: Points, sol: Solution, co_ion: int) -> Ratio:
    """X = |cF| / ca; 0 where there is no co-ion."""
    ca, k = sol.ca[:, co_ion], sol.kappa[:, co_ion]
    safe = np.where(ca > 0.0, ca, 1.0)
    X = np.where(ca > 0.0, np.abs(sol.cF) / safe, 0.0)
    by_J = -(1.0 / (pts.J - sol.phi0) + sol.dkdJ[:, co_ion] / np.where(k > 0.0, k, 1.0)) * X
    by_c = -(X / safe)[:, None] * sol.by_concentration(co_ion)
    return Ratio(X, by_J, by_c, ca)
