"""Effective concentrations at the nodes of parts, and what the solution has at their points."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.model.species import solutes
from febkit.solver.fields import concentration

from .base import Face, Floats, Part, mean, register


def concentrations(part: Part) -> Floats | None:
    """Effective concentrations (node, solute of the model), zero where a part lacks one; None: it has none at all."""
    if part.group is None:
        return None
    layout, d, nodes = part.state.layout, part.state.d, part.mesh.nodes()
    every = [f.name for f in layout.fields if f.name.startswith("concentration")]
    if not any(n in part.group.fields for n in every):
        return None
    out = np.zeros((len(nodes), len(every)))
    for k, n in enumerate(every):
        if n in part.group.fields:
            out[:, k] = layout.scalar(d, n)[nodes]
    return out


def osmotic_coefficient(part: Part) -> Floats | None:
    """(m, g), None where nothing is dissolved."""
    physics: Any = part.g.physics
    return physics.osmotic_coefficient(part.points()) if part.g.block.physics.name == "multiphasic" else None


def gaps(face: Face) -> Floats | None:
    """Differences of the effective concentrations across a contact (facet, solute of the model)."""
    from .contacts import step

    found = [step(face, concentration(s.index + 1).name) for s in solutes(face.view.model)]
    known = [v for v in found if v is not None]
    return np.stack(known, axis=1) if known else None


register("effective solute concentration", concentrations)
register("osmotic coefficient", mean(osmotic_coefficient))
register("concentration gap", gaps)
