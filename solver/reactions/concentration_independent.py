"""Reactions whose rate does not depend on solutes."""

from __future__ import annotations

from dataclasses import dataclass

from . import register
from .mass_action_forward import MassActionForward


@dataclass(eq=False)
class ConcentrationIndependent(MassActionForward):
    """zeta = k times the powers of solid-bound reactants; solutes are made or used up whatever is there."""

    solutes = False


register(ConcentrationIndependent, "concentration-independent")
