"""Pore pressures at the nodes of parts, fluxes at the nodes of elements, permeability, elasticity of mixtures."""

from __future__ import annotations

from febkit.solver.fields import PRESSURE

from . import laws
from .base import Floats, Part, at_nodes, mean, of_solids, register
from .stresses import upper


def pressure(part: Part) -> Floats | None:
    """Effective fluid pressure at the nodes of a part that solves for it (node,)."""
    if part.group is None or PRESSURE.name not in part.group.fields:
        return None
    return part.state.layout.scalar(part.state.d, PRESSURE.name)[part.mesh.nodes()]


def permeability(part: Part) -> Floats | None:
    """Hydraulic permeability (m, g, 6), of biphasic parts alone, as FEBio has it."""
    k = part.g.physics.permeability(part.points()) if part.g.block.physics.name == "biphasic" else None
    return None if k is None else part.shaped(k)


def mixture_elasticity(part: Part) -> Floats | None:
    """Spatial elasticity of a mixture at fixed effective pressure and concentrations (m, g, 21)."""
    from febkit.solver.kernels.mixture_tangent import add_pressure

    pts = part.points()
    p = part.g.physics.pressure(pts)
    if p is None:
        return None
    C = laws.tangent(part.g.block.solid.stress, pts)
    add_pressure(C, *p)
    return upper(part, 0.5 * (C + C.transpose(0, 2, 1)))


register("effective fluid pressure", pressure)
register("nodal fluid flux", at_nodes(of_solids(lambda part: part.at_points("fluid flux"))))
register("permeability", mean(of_solids(permeability)))
register("effective elasticity", mean(of_solids(mixture_elasticity)))
