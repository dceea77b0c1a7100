"""Variables of what febkit's solver does not solve: second-order materials, mortar contacts, contacts of edges."""

from __future__ import annotations

from .base import Face, Part, register


def absent(of: Part | Face) -> None:
    """Nothing that is solved has it."""


register("G norm", absent)
register("QK1 norm", absent)
register("mortar-gap", absent)
register("edge contact gap", absent)
