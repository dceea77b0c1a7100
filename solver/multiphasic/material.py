"""The fluid, solutes and charges of a mixture."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..law import Floats
from ..osmotic_coefficients.base import OsmoticCoefficient
from ..permeabilities.base import Permeability
from ..reactions.base import Reaction
from ..values import Constant, Value
from .species import SolidBound, Solute

if TYPE_CHECKING:
    from ..membrane_reactions.base import MembraneReaction


@dataclass(eq=False)
class Mixture:
    """What FEBio's materials biphasic-solute, triphasic and multiphasic have in common.

    R, T, Fc: gas constant, temperature, Faraday constant; phi0: referential volume fraction of the solid without its
    bound molecules; fixed_charge: referential fixed charge density per fluid volume; penalty: weight of the current
    density in every solute's balance (FEBio's ``penalty``: charge is conserved the more firmly). ``neutral``: charge
    numbers play no part (biphasic-solute). model_solutes, model_bound: how many the model has, of which
    these are some. ``membrane``: reactions with what is on the faces of a shell.
    """

    permeability: Permeability
    osmotic_coefficient: OsmoticCoefficient
    solutes: tuple[Solute, ...]
    R: float
    T: float
    Fc: float = 0.0
    phi0: Value = field(default_factory=lambda: Constant(0.0))
    fixed_charge: Value = field(default_factory=lambda: Constant(0.0))
    penalty: float = 1.0
    neutral: bool = False
    supply: Any = None
    solid_bound: tuple[SolidBound, ...] = ()
    reactions: tuple[Reaction, ...] = ()
    membrane: tuple[MembraneReaction, ...] = ()
    model_solutes: int = 0
    model_bound: int = 0

    @property
    def RT(self) -> float:
        return self.R * self.T

    @cached_property
    def z(self) -> Floats:
        """Charge numbers (m,), zero in a neutral mixture."""
        return np.array([0.0 if self.neutral else float(s.charge) for s in self.solutes])

    @cached_property
    def current(self) -> Floats:
        """Weights (m,) of the solutes' fluxes in every solute's balance: the current density's penalty."""
        return self.penalty * self.z

    @cached_property
    def every_reaction(self) -> tuple[Reaction, ...]:
        """Those inside the mixture, and those with what is on its faces."""
        return (*self.reactions, *self.membrane)

    @cached_property
    def volumes(self) -> Floats:
        """Molar volumes of the solutes (m,)."""
        return np.array([s.molar_mass / s.density for s in self.solutes])

    @cached_property
    def binds(self) -> bool:
        """Does the first solute's supply bind it to receptors (biphasic-solute)?"""
        return bool(self.solutes) and self.solutes[0].supply is not None
