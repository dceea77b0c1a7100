"""Pore pressures at the nodes of parts, fluxes at the nodes of elements, permeability, elasticity of mixtures."""

from __future__ import annotations

import numpy as np

from febkit.solver.fields import PRESSURE

from .base import Floats, Part, at_nodes, mean, of_solids, register
from .stresses import UPPER, elasticity


def pressure(part: Part) -> Floats | None:
    """Effective fluid pressure at the nodes of a part that solves for it (node,)."""
    if part.group is None or PRESSURE.name not in part.group.fields:
        return None
    return part.state.layout.scalar(part.state.d, PRESSURE.name)[part.mesh.nodes()]


def permeability(part: Part) -> Floats | None:
    """Hydraulic permeability (m, g, 6)."""
    k = part.g.physics.permeability(part.points())
    return None if k is None else part.shaped(k)


def mixture_elasticity(part: Part) -> Floats | None:
    """Spatial elasticity of the solid and of the fluid's pressure, c - p (I dyad I - 2 I circle I) (m, g, 21)."""
    p = part.at_points("fluid pressure")
    if p is None:
        return None
    unit = np.zeros((6, 6))
    unit[:3, :3] = -1.0
    unit += np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])
    return elasticity(part) + p[..., None] * np.array([unit[i, j] for i, j in UPPER])


register("effective fluid pressure", pressure)
register("nodal fluid flux", at_nodes(of_solids(lambda part: part.at_points("fluid flux"))))
register("permeability", mean(of_solids(permeability)))
register("effective elasticity", mean(of_solids(mixture_elasticity)))
