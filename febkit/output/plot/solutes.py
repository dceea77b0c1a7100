"""Effective concentrations at the nodes of parts."""

from __future__ import annotations

import numpy as np

from .base import Floats, Part, register


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


register("effective solute concentration", concentrations)
