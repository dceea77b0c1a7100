"""Pore pressures at the nodes of parts, fluxes at the nodes of elements."""

from __future__ import annotations

from febkit.solver.fields import PRESSURE

from .base import Floats, Part, at_nodes, of_solids, register


def pressure(part: Part) -> Floats | None:
    """Effective fluid pressure at the nodes of a part that solves for it (node,)."""
    if part.group is None or PRESSURE.name not in part.group.fields:
        return None
    return part.state.layout.scalar(part.state.d, PRESSURE.name)[part.mesh.nodes()]


register("effective fluid pressure", pressure)
register("nodal fluid flux", at_nodes(of_solids(lambda part: part.at_points("fluid flux"))))
