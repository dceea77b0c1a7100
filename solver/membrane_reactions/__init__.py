"""Membrane reactions by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from ..registry import Registry
from .base import MembraneReaction

TYPES = {
    "membrane-mass-action-forward": "mass_action",
    "membrane-mass-action-reversible": "mass_action",
}
_all: Registry[MembraneReaction] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
