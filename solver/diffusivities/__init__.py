"""Solute diffusivities by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from ..registry import Registry
from .base import Diffusivity

TYPES = {
    "diff-const-iso": "const_iso",
    "diff-const-ortho": "const_ortho",
    "diff-ref-iso": "ref_iso",
    "diff-Albro-iso": "albro_iso",
}
_all: Registry[Diffusivity] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
