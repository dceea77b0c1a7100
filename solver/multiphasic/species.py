"""Solutes and solid-bound molecules of a mixture."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..diffusivities.base import Diffusivity
from ..solubilities.base import Solubility
from ..solute_supplies.base import SoluteSupply
from ..values import Constant, Value


@dataclass(eq=False)
class Solute:
    """``index``: its place among the model's solutes, from 0. charge number z, molar mass M, true density."""

    name: str
    index: int
    diffusivity: Diffusivity
    solubility: Solubility
    charge: int = 0
    molar_mass: float = 1.0
    density: float = 1.0
    supply: SoluteSupply | None = None


@dataclass(eq=False)
class SolidBound:
    """A molecule bound to the solid: referential apparent density rho0 at the start, kept within rhomin and rhomax.

    ``rhomax`` 0: no upper bound.
    """

    name: str
    index: int
    charge: int = 0
    molar_mass: float = 1.0
    density: float = 1.0
    rho0: Value = field(default_factory=lambda: Constant(0.0))
    rhomin: float = 0.0
    rhomax: float = 0.0
