"""Loads on bodies and surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.solver.loads.bearing import Bearing
from febkit.solver.loads.enclosed_volume import IdealGas

from .base import Face, Floats, Part, mean, of_solids, register


def body_force(part: Part) -> Floats:
    """Acceleration that the body loads of a part give it (m, g, 3)."""
    system = part.run.system
    out = np.zeros((part.g.m, part.g.g, 3))
    for load in system.body_loads if system is not None else ():
        if load.blocks is None or part.name in load.blocks:
            out = out + part.shaped(load.acceleration(part.state, part.group))
    return out


def on(face: Face, kind: Any) -> Any:
    """The load of a kind that acts on a surface; None where none does."""
    system = face.view.run.system
    nodes = set(face.nodes.tolist())
    for load in system.loads if system is not None else ():
        if isinstance(load, kind) and {n for p in load.surface for n in p.conn.ravel().tolist()} == nodes:
            return load
    return None


def bearing(face: Face) -> Floats | None:
    """Mean pressure of a bearing load over each facet; no other load has a scalar in FEBio."""
    load = on(face, Bearing)
    if load is None:
        return None
    parts = load._pressures(face.state)
    return np.concatenate([-load.sign * P.reshape(len(p.conn), -1).mean(axis=1) for p, P in parts])


def gas(face: Face) -> Floats | None:
    """Pressure of the gas that a surface encloses."""
    load = on(face, IdealGas)
    return None if load is None else np.asarray(load.pressure(face.state))


register("body force", mean(of_solids(body_force)))
register("scalar surface load", bearing)
register("ideal gas pressure", gas)
