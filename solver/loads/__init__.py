"""Loads by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from importlib import import_module
from typing import Any

TYPES = {
    # surface loads
    "pressure": "pressure",
    "traction": "traction",
    "force": "force",
    "bearing load": "bearing",
    "normal_traction": "normal_traction",
    "fluidflux": "fluid_flux",
    # nodal loads
    "nodal_load": "nodal",
    "nodal_force": "nodal",
    "nodal_target_force": "nodal",
    "nodal fluidflux": "nodal",
    # rigid bodies
    "rigid_force": "rigid",
    "rigid_moment": "rigid",
    "rigid_follower_force": "rigid",
    "rigid_follower_moment": "rigid",
    # body loads
    "body force": "body_force",
    "const": "body_force",
    "non-const": "body_force",
    "centrifugal": "centrifugal",
    "mass damping": "mass_damping",
    "moving frame": "moving_frame",
}
_classes: dict[str, Any] = {}


def register(cls: Any, *febio_types: str) -> None:
    """Make a class known by FEBio's type names; the last line of a load's file."""
    _classes.update(dict.fromkeys(febio_types, cls))


def known(febio_type: str) -> bool:
    return febio_type in TYPES


def load(febio_type: str) -> Any:
    """The class of a load type; KeyError where there is none."""
    import_module(f"{__name__}.{TYPES[febio_type]}")
    return _classes[febio_type]
