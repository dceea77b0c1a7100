"""What is at the back faces of shells, and how thick these are.

Back faces have nodes of their own (:mod:`febkit.solver.shells`), whose values FEBio writes at the nodes in front.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from febkit.model.species import solid_bound, solutes
from febkit.solver.fields import PRESSURE, concentration

from .base import Floats, Part, View, mean, register, shared

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


def pressure(part: Part) -> Floats | None:
    """Effective fluid pressure behind the nodes of a shell that solves for it (node,)."""
    if not part.shell or part.group is None or PRESSURE.name not in part.group.fields:
        return None
    return part.state.layout.scalar(part.state.d, PRESSURE.name)[behind(part.view)[part.mesh.nodes()]]


def solute(part: Part, named: str = "") -> Floats | None:
    """Effective concentration behind of the solute of this name, or of this number from 0; of solids that have it too,
    zero at nodes that nothing is behind."""
    found = [concentration(s.index + 1).name for s in solutes(part.view.model) if named in (s.name, str(s.index))]
    if not found or part.group is None or found[0] not in part.group.fields:
        return None
    return of_nodes(part.view, part.state.layout.scalar(part.state.d, found[0]))[part.mesh.nodes()]


def at_elements(part: Part) -> Floats | None:
    """Directors at the nodes of each element (m, n, 3)."""
    return directors(part.view)[part.mesh.conn] if part.shell and part.group is not None else None


def thickness(part: Part) -> Floats | None:
    """Lengths of the directors (m, n)."""
    d = at_elements(part)
    return None if d is None else np.asarray(np.linalg.norm(d, axis=-1))


def areal(part: Part) -> Floats | None:
    """Moles of solid-bound molecules per area of a shell (m, g, solid-bound molecule of the model): rho_r h / (J M)."""
    bound = part.at_points("sbm referential apparent density") if part.shell else None
    h = thickness(part)
    if bound is None or h is None:
        return None
    g, n = part.g, part.g.n // 2
    M = g.N[:, :n] + g.N[:, n:]
    molar = np.array([s.molar_mass for s in solid_bound(part.view.model)])
    return np.asarray(bound * ((h @ M.T) / g.J)[..., None] / molar)


register("shell displacement", lambda view: of_nodes(view, view.state.u))
register("nodal shell director", directors)
register("effective shell fluid pressure", pressure)
register("effective shell solute concentration", solute, more=True)
register("shell director", at_elements)
register("shell thickness", thickness)
register("sbm areal concentration", mean(areal))
