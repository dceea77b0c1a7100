"""Loads by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from typing import Any

from ..registry import Registry

TYPES = {
    # surface loads
    "pressure": "pressure",
    "traction": "traction",
    "force": "force",
    "bearing load": "bearing",
    "normal_traction": "normal_traction",
    "fluidflux": "fluid_flux",
    "solute natural flux": "solute_natural_flux",
    "soluteflux": "solute_flux",
    "ideal gas pressure": "enclosed_volume",
    "pressure Robin BC": "robin",
    "traction Robin BC": "robin",
    # nodal loads
    "nodal_load": "nodal",
    "nodal_force": "nodal",
    "nodal_target_force": "nodal",
    "nodal fluidflux": "nodal",
    # rigid bodies
    "rigid_force": "rigid",
    "rigid_moment": "rigid",
    "rigid_follower_force": "rigid",
    "rigid_cable": "rigid",
    "rigid_follower_moment": "rigid",
    # body loads
    "body force": "body_force",
    "const": "body_force",
    "non-const": "body_force",
    "centrifugal": "centrifugal",
    "axial force": "central_force",
    "radial force": "central_force",
    "mass damping": "mass_damping",
    "moving frame": "moving_frame",
}
_all: Registry[Any] = Registry(__name__, TYPES)
register, known, load = _all.register, _all.known, _all.load
