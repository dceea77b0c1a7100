"""Chemical reactions by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from ..registry import Registry
from .base import Reaction

TYPES = {
    "mass-action-forward": "mass_action_forward",
    "mass-action-forward-effective": "mass_action_forward",
    "mass-action-reversible": "mass_action_reversible",
    "mass-action-reversible-effective": "mass_action_reversible",
    "Michaelis-Menten": "michaelis_menten",
    "concentration-independent": "concentration_independent",
}
_all: Registry[Reaction] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
