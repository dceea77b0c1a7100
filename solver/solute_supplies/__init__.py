"""Supplies of a solute by the solid by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from ..registry import Registry
from .base import SoluteSupply

TYPES = {
    "supply-const": "const",
    "supply-binding": "binding",
    "supply-synthesis-binding": "synthesis_binding",
    "supply-Michaelis-Menten": "michaelis_menten",
}
_all: Registry[SoluteSupply] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
