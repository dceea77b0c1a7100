"""Rates of membrane reactions by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from ..registry import Registry
from .base import MembraneRate

TYPES = {
    "membrane constant reaction rate": "constant",
    "membrane ion channel reaction rate": "ion_channel",
    "membrane voltage-gated reaction rate": "voltage_gated",
}
_all: Registry[MembraneRate] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
