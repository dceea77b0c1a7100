"""What is at the back faces of shells, and how thick these are.

Back faces have nodes of their own (:mod:`febkit.solver.shells`), whose values FEBio writes at the nodes in front.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from febkit.model.species import solutes
from febkit.solver.fields import PRESSURE, concentration

from .base import Floats, Part, View, register, shared

Ints = NDArray[np.int64]


@shared
def behind(view: View) -> Ints:
    """The back node of each node of the mesh, -1 where it has none (node,)."""
    out = np.full(len(view.mesh.X), -1)
    for part in view.parts:
        if part.shell and part.group is not None:
            back, front = np.split(part.group.conn, 2, axis=1)
            out[front] = back
    return out


def of_nodes(view: View, nodal: Floats) -> Floats:
    """Values of a nodal array (node, ...) behind the nodes, zero where nothing is behind."""
    back, out = behind(view), np.zeros_like(nodal)
    front = np.flatnonzero(back >= 0)
    out[front] = nodal[back[front]]
    return out


def directors(view: View) -> Floats:
    """From the back node of each node to it (node, 3), zero where there is none."""
    back = behind(view)
    return np.where((back >= 0)[:, None], view.state.x[: len(back)] - view.state.x[back], 0.0)


def _behind(part: Part, field: str) -> Floats | None:
    """A nodal field (node,) behind the nodes of a shell that solves for it."""
    if not part.shell or part.group is None or field not in part.group.fields:
        return None
    return part.state.layout.scalar(part.state.d, field)[behind(part.view)[part.mesh.nodes()]]


def pressure(part: Part) -> Floats | None:
    """Effective fluid pressure behind."""
    return _behind(part, PRESSURE.name)


def solute(part: Part, named: str = "") -> Floats | None:
    """Effective concentration behind of the solute of this name, or of this number from 0."""
    found = [s for s in solutes(part.view.model) if named in (s.name, str(s.index))]
    return _behind(part, concentration(found[0].index + 1).name) if found else None


def at_elements(part: Part) -> Floats | None:
    """Directors at the nodes of each element (m, n, 3)."""
    return directors(part.view)[part.mesh.conn] if part.shell and part.group is not None else None


def thickness(part: Part) -> Floats | None:
    """Lengths of the directors (m, n)."""
    d = at_elements(part)
    return None if d is None else np.asarray(np.linalg.norm(d, axis=-1))


register("shell displacement", lambda view: of_nodes(view, view.state.u))
register("nodal shell director", directors)
register("effective shell fluid pressure", pressure)
register("effective shell solute concentration", solute, more=True)
register("shell director", at_elements)
register("shell thickness", thickness)
