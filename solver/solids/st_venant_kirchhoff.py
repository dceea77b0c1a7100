"""St. Venant-Kirchhoff solid: the law of :mod:`.isotropic_elastic` under its other name."""

from __future__ import annotations

from dataclasses import dataclass

from .isotropic_elastic import IsotropicElastic
from .registry import register


@dataclass(eq=False)
class StVenantKirchhoff(IsotropicElastic):
    """S = lambda tr(E) I + 2 mu E."""


register(StVenantKirchhoff, "St.Venant-Kirchhoff")
