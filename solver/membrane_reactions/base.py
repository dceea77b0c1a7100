"""What a membrane reaction is: one among a shell's solutes and bound molecules and the solutes on its two faces."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

from ..law import Floats
from ..multiphasic.solution import Solution
from ..points import Points
from ..reactions.base import Reaction


@dataclass(eq=False)
class MembraneReaction(Reaction):
    """Supply zeta (moles per area of the membrane and time).

    reactants_outside, products_outside (2, M): stoichiometric coefficients of the model's solutes in front and behind;
    charges (M,): their charge numbers. Of the shell's own species it is a reaction like another. ``by_sides`` (n, 2, M)
    and ``by_strain`` (n,) are derivatives of zeta by the effective concentrations outside and the areal strain.
    """

    reactants_outside: Floats = field(kw_only=True)
    products_outside: Floats = field(kw_only=True)
    charges: Floats = field(kw_only=True)

    @cached_property
    def yields(self) -> Floats:
        """Moles of each solute that a face gains for one of the reaction (2, M).

        The net coefficients, and on each face the charge that they make there besides: FEBio's unit penalty, as that of
        the current in a mixture.
        """
        net = self.products_outside - self.reactants_outside
        return net + (net @ self.charges)[:, None]

    def by_sides(self, pts: Points, sol: Solution) -> Floats:
        raise NotImplementedError

    def by_strain(self, pts: Points, sol: Solution) -> Floats:
        raise NotImplementedError
