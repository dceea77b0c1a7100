"""What a solvent supply is."""

from __future__ import annotations

from typing import ClassVar

from ..law import Floats, Law
from ..points import Points
from ..record import variable_record


@variable_record
class Supply(Law):
    """Volume of fluid made per current mixture volume and time.

    ``supply(pts, p, q, dE, dp)`` *adds* the supply at pressures ``p`` (n,) to ``q`` (n,), its pressure
    derivative to ``dp`` (n,) and, where ``strain_dependent``, its strain tangent to ``dE`` (n, 6), J dE
    being the rate of q per unit spatial strain rate; ``dE`` and ``dp`` may be None.
    """

    strain_dependent: ClassVar[bool] = False

    def supply(self, pts: Points, p: Floats, q: Floats, dE: Floats | None, dp: Floats | None) -> None:
        raise NotImplementedError
