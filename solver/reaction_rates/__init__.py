"""Rate laws of chemical reactions by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from ..registry import Registry
from .base import ReactionRate

TYPES = {
    "constant reaction rate": "constant",
    "exp-sed reaction rate": "strained",
    "Huiskes reaction rate": "strained",
    "Nims reaction rate": "nims",
    "Ruberti reaction rate": "strained",
    "solute-as-sbm reaction rate": "solute_as_sbm",
}
_all: Registry[ReactionRate] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
