"""Solvent supplies by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from importlib import import_module

from .base import Supply

TYPES = {"Starling": "starling"}
_classes: dict[str, type[Supply]] = {}


def register(cls: type[Supply], febio_type: str) -> None:
    """Make a class known by FEBio's type name; the last line of a supply's file."""
    _classes[febio_type] = cls


def known(febio_type: str) -> bool:
    return febio_type in TYPES


def load(febio_type: str) -> type[Supply]:
    """The class of a supply type; KeyError where there is none."""
    import_module(f"{__name__}.{TYPES[febio_type]}")
    return _classes[febio_type]
