"""A solid without stress: what has mass alone, or no solid at all."""

from __future__ import annotations

from dataclasses import dataclass

from ..points import Points
from .base import Floats, Solid


@dataclass(eq=False)
class Inert(Solid):
    """Mass, and no stress."""

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        """Nothing."""
