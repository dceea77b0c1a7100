"""A solid without stress: what has mass alone, or no solid at all."""

from __future__ import annotations

from ..points import Points
from ..record import variable_record
from .base import Floats, Solid


@variable_record
class Inert(Solid):
    """Mass, and no stress."""

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        """Nothing."""
