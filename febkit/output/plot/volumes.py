"""Representative volumes at the integration points of "micro-material"."""

from __future__ import annotations

import numpy as np

from .base import Floats, Part, mean, register
from .stresses import cauchy, first


def norm(part: Part) -> Floats | None:
    """P : P of the mean first Piola-Kirchhoff stress P of each volume (m, g)."""
    P = first(part) if type(part.g.block.solid).__name__ == "Micro" else None
    return None if P is None else (P**2).sum(axis=2)


def energy(part: Part) -> Floats | None:
    """Mean of P : F over each volume (m, g): J tr sigma of the means, as its boundary moves by F (Hill, Mandel)."""
    s = cauchy(part) if type(part.g.block.solid).__name__ == "Micro" else None
    return None if s is None else part.g.J * np.trace(s, axis1=-2, axis2=-1)


register("PK1 norm", mean(norm))
register("micro energy", mean(energy))
