"""Osmotic coefficients by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from ..registry import Registry
from .base import OsmoticCoefficient

TYPES = {
    "osm-coef-const": "const",
    "osm-coef-Manning": "manning",
}
_all: Registry[OsmoticCoefficient] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
