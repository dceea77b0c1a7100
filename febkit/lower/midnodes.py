"""<mixed_formulation>: fluid pressures that are linear between the corners of elements with nodes on their edges."""

from __future__ import annotations

import numpy as np

from febkit.solver import elements
from febkit.solver.fields import PRESSURE
from febkit.solver.ties import LinearConstraint

from .context import Context

LINEAR = {4: "tet4", 5: "pyra5", 6: "penta6", 8: "hex8"}  # by number of corners
ROUND = 1e-12  # shape functions below are those of corners that a node does not lie between


def constraints(ctx: Context) -> list[LinearConstraint]:
    """The pressure of a node between corners, by the linear element's shape functions.

    Forces conjugate to it go to the corners alike: trial and test functions are the linear element's.
    """
    if not ctx.layout.has("p"):
        return []
    column, out = ctx.layout.column("p"), {}
    for b in ctx.made:
        e = elements.get(b.element)
        if PRESSURE not in b.physics.fields or e.nodes == e.corners or b.element.startswith("shell_"):
            continue
        weights = elements.get(LINEAR[e.corners]).shape(e.natural[e.corners :])
        for local, w in enumerate(weights, e.corners):
            at = np.flatnonzero(np.abs(w) > ROUND)
            for node, corners in zip(b.conn[:, local].tolist(), b.conn[:, at], strict=True):
                if node not in out:
                    columns = np.full(len(at), column)
                    out[node] = LinearConstraint(node, column, corners, columns, tuple(w[at].tolist()))
    return list(out.values())
