"""What a reaction rate is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from ..law import Floats, Law
from ..multiphasic.solution import Solution
from ..points import Points


@dataclass(eq=False)
class ReactionRate(Law):
    """Rate k of a reaction: ``rate`` gives it (1|n,), ``by_J`` its derivative by J (n,), or None where that is zero.

    ``remembers``: the law keeps one number for each point, ``sol.memory[id(law)]`` (n,), which ``begin_step`` renews
    at the converged state a step starts from.
    """

    remembers: ClassVar[bool] = False

    def rate(self, pts: Points, sol: Solution) -> Floats:
        raise NotImplementedError

    def by_J(self, pts: Points, sol: Solution) -> Floats | None:
        return None

    def attach(self, solid: Any, used: Floats, made: Floats, molar: Floats) -> None:
        """Take the solid of the material and, of its solid-bound molecules (b,), what the reaction uses up and makes
        (stoichiometric coefficients) and the molar masses.

        Raises ValueError where the law makes no sense with them.
        """

    def evaluated(self, pts: Points, kept: Floats) -> None:
        """The state has been evaluated: renew what is remembered (n,) of it."""

    def begin_step(self, pts: Points, sol: Solution) -> None:
        """Renew what is remembered."""
