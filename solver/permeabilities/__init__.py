"""Hydraulic permeabilities by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from importlib import import_module

from .base import Permeability

TYPES = {
    "perm-const-iso": "const_iso",
    "perm-Holmes-Mow": "holmes_mow",
    "perm-exp-iso": "exp_iso",
    "perm-ref-iso": "ref_iso",
    "perm-ref-trans-iso": "ref_trans_iso",
    "perm-ref-ortho": "ref_ortho",
}
_classes: dict[str, type[Permeability]] = {}


def register(cls: type[Permeability], febio_type: str) -> None:
    """Make a class known by FEBio's type name; the last line of a permeability's file."""
    _classes[febio_type] = cls


def known(febio_type: str) -> bool:
    return febio_type in TYPES


def load(febio_type: str) -> type[Permeability]:
    """The class of a permeability type; KeyError where there is none."""
    import_module(f"{__name__}.{TYPES[febio_type]}")
    return _classes[febio_type]
