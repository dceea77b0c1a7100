"""Hydraulic permeabilities by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from ..registry import Registry
from .base import Permeability

TYPES = {
    "perm-const-iso": "const_iso",
    "perm-Holmes-Mow": "holmes_mow",
    "perm-exp-iso": "exp_iso",
    "perm-ref-iso": "ref_iso",
    "perm-ref-trans-iso": "ref_trans_iso",
    "perm-ref-ortho": "ref_ortho",
}
_all: Registry[Permeability] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
