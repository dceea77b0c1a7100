"""Nodal fields of the whole mesh (node, 3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .base import Floats, View, register, shared


@shared
def unbalanced(view: View) -> Floats:
    """External minus internal forces (node, 3): zero at free nodes, and minus what holds the others."""
    s, system = view.state, view.run.system
    R = np.zeros_like(s.d)
    s.layout.u(R)[...] = -s.reaction
    if system is not None:
        before = [c.snapshot() for c in system.contacts]
        system.add_external(R)
        for contact, kept in zip(system.contacts, before, strict=True):
            contact.restore(kept)
    return s.layout.u(R)


def held(view: View) -> NDArray[np.bool_]:
    """Which displacements (node, 3) are not free."""
    system = view.run.system
    if system is None:
        return np.ones(view.state.u.shape, bool)
    return ~system.eqs.is_free[:, view.state.layout.displacement]


@shared
def reactions(view: View) -> Floats:
    """Forces of the model on what holds it, minus those of supports; where a node is free, minus its internal force.

    FEBio has zeros where <bc type="zero displacement"> holds a node, and a body's sum at each node of a rigid body.
    """
    return np.where(held(view), unbalanced(view), -view.state.reaction)


def incremental(view: View) -> Floats:
    """Displacement since the last state of the plotfile."""
    x = view.state.x
    before = view.state.extra.get("plotted", x)
    view.state.extra["plotted"] = x
    return x - before


def rotation(view: View) -> Floats:
    """Rotation vector of a beam's node, zero elsewhere."""
    s = view.state
    return s.of("rotation") if s.layout.turns else np.zeros_like(s.X)


register("displacement", lambda view: view.state.u)
register("nodal velocity", lambda view: view.state.velocity)
register("nodal acceleration", lambda view: view.state.acceleration)
register("reaction forces", reactions)
register("incremental displacement", incremental)
register("rotation", rotation)
