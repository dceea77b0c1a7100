"""Surfaces of mixtures that slide on each other with friction."""

from __future__ import annotations

from dataclasses import dataclass

from . import register
from .biphasic_friction import BiphasicFriction
from .sliding_multiphasic import SlidingMultiphasic


@dataclass(eq=False)
class MultiphasicFriction(BiphasicFriction, SlidingMultiphasic):
    """As :class:`~.sliding_multiphasic.SlidingMultiphasic`, with the friction of :class:`.BiphasicFriction`.

    The fluid bears what its pressure is above the ``ambient_pressure``. FEBio User Manual, "Sliding-Multiphasic".
    """


register(MultiphasicFriction, "sliding-multiphasic with friction")
