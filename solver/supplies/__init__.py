"""Solvent supplies by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from ..registry import Registry
from .base import Supply

TYPES = {"Starling": "starling"}
_all: Registry[Supply] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
