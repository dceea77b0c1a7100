"""Which data records know, whatever their kind."""

from __future__ import annotations

from . import bodies, connectors, domains, elements, faces, model, nodes, surfaces


def known(name: str) -> bool:
    """Is there a datum of this name in a record of some kind? A formula ("_math") begins with "=" in a record."""
    nodal = name[-1] in "xyz" and name[:-1] in nodes.VECTORS
    listed = {*nodes.ALIASES, *nodes.REACTIONS, *connectors.VOLUMES, *faces.ITEMS, *surfaces.ITEMS, *domains.FUNCTIONS,
              *domains.WHOLE, surfaces.GAP, model.NORM, "_math"}  # fmt: skip
    return nodal or name in listed or any(f(name) for f in (elements.datum, bodies.datum, connectors.datum))
