"""What a reaction rate is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

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

    def begin_step(self, pts: Points, sol: Solution) -> None:
        """Renew what is remembered."""
