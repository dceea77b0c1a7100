"""Nodal fields of the whole mesh (node, 3)."""

from __future__ import annotations

import numpy as np

from .base import Floats, View, register


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
register("reaction forces", lambda view: view.state.reaction)
register("incremental displacement", incremental)
register("rotation", rotation)
