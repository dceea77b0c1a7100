"""<node_data>: positions, displacements, velocities, accelerations, reactions, any degree of freedom by its name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from febkit.model.sets import node_indices

from . import Column, Floats, Ints, places

if TYPE_CHECKING:
    from febkit.model import LogEntry
    from febkit.output.plot import View

VECTORS = {"": "x", "u": "u", "v": "velocity", "a": "acceleration"}  # of the state, by prefix
REACTIONS = ("Rx", "Ry", "Rz")
BACK = {"q": "p"} | {f"d{k}": f"c{k}" for k in range(1, 9)} | {f"s{a}": a for a in "xyz"}  # of the backs of shells
ALIASES = {"pe": "p", "c": "c1"} | {f"ce{k}": f"c{k}" for k in range(1, 9)}


def rows(view: View, entry: LogEntry) -> tuple[Ints, Ints]:
    mesh = view.model.mesh
    chosen = mesh.node_ids[node_indices(mesh, entry.set, entry.where)] if entry.set else None
    return places(entry, mesh.node_ids, chosen)


def column(view: View, name: str, entry: LogEntry) -> Column | None:
    if name and name[-1] in "xyz" and name[:-1] in VECTORS:
        vector, k = VECTORS[name[:-1]], "xyz".index(name[-1])
        return lambda: getattr(view.state, vector)[:, k]
    if name in REACTIONS:
        return lambda: _reaction(view)[:, REACTIONS.index(name)]
    dof = ALIASES.get(name, name)
    if view.state.layout.has(dof):
        return lambda: view.state.d[:, view.state.layout.column(dof)]
    if view.state.layout.has(BACK.get(name, "")):
        from febkit.output.plot.shells import of_nodes

        return lambda: of_nodes(view, view.state.d)[:, view.state.layout.column(BACK[name])]
    return None


def _reaction(view: View) -> Floats:
    """The support's force, zero at free nodes; of mixtures FEBio writes what the plot has, of the other sign."""
    from febkit.output.plot.nodes import held, reactions

    plotted = reactions(view)
    return plotted if view.state.layout.mixed else np.where(held(view), -plotted, 0.0)
