"""Shells become solids: back nodes one director behind the nodes of the mesh, and thick elements between.

FEBio's nodes of a shell lie on its front (top) face; a second displacement at each node moves the back
(bottom) face. Here the back face gets nodes of its own, so that a shell is a solid element like any other
(:mod:`.elements.shell`): its "shell displacement" is the displacement of the back node.
Sources: FEBio Theory Manual, "Shell elements"; Hou et al., J. Biomech. Eng. 140 (2018) 121001.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import elements

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Shell:
    """Shell elements over facets ("quad4") with nodes ``conn`` (m, n) and thickness (m, n) at each."""

    facet: str
    conn: Ints
    thickness: Floats


@dataclass(frozen=True, eq=False)
class Solid:
    """Solid elements ("hex8") with nodes ``conn`` (m, n)."""

    element: str
    conn: Ints


@dataclass(frozen=True, eq=False)
class Thickened:
    """Nodes with the back nodes after the mesh's own, and connectivities that use them.

    ``back`` (node of the mesh,) is the index of a node's back node, -1 where it has none; elements of
    ``shells`` are (bottom nodes, top nodes) of ``shell_<facet>``; ``solids`` are attached to the back face
    where FEBio attaches them.
    """

    X: Floats
    back: Ints
    shells: tuple[Ints, ...]
    solids: tuple[Ints, ...]


def directors(X: Floats, shells: Sequence[Shell]) -> tuple[Floats, NDArray[np.bool_]]:
    """Directors (node, 3) from back to front, and which nodes have one.

    At each node the mean, over the shells around it, of thickness times unit normal; an element's normal
    at its node j is that of the edges to the next and the last node of its list (middle nodes included).
    """
    D, count = np.zeros_like(X), np.zeros(len(X))
    for s in shells:
        x = X[s.conn]
        n = np.cross(np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x)
        n *= (s.thickness / np.linalg.norm(n, axis=2))[:, :, None]
        np.add.at(D, s.conn.ravel(), n.reshape(-1, 3))
        np.add.at(count, s.conn.ravel(), 1.0)
    has = count > 0
    D[has] /= count[has, None]
    return D, has


def thicken(X: Floats, shells: Sequence[Shell], solids: Sequence[Solid] = ()) -> Thickened:
    """Give shells their back nodes. Raises ValueError where a thickness is not positive."""
    for s in shells:
        if not (s.thickness > 0).all():
            raise ValueError("the thickness of a shell must be positive")
    D, has = directors(X, shells)
    back = np.full(len(X), -1, dtype=np.int64)
    back[has] = len(X) + np.arange(int(has.sum()))
    return Thickened(
        X=np.vstack([X, (X - D)[has]]),
        back=back,
        shells=tuple(np.hstack([back[s.conn], s.conn]) for s in shells),
        solids=_attach(X, back, shells, solids),
    )


def _attach(X: Floats, back: Ints, shells: Sequence[Shell], solids: Sequence[Solid]) -> tuple[Ints, ...]:
    """Solids with the nodes of faces at the back of shells moved to the back nodes.

    A solid is at the back where its outward normal on the shared face goes along the shell's. All elements
    of the first such part then take the back node wherever they touch the shell, as in FEBio.
    """
    out = [q.conn.copy() for q in solids]
    faces = [_faces(q) for q in solids]
    for s in shells:
        normal = _normals(X, s.conn)
        corners = elements.shape(s.facet).corners
        first: tuple[int, int] | None = None  # shell element and solid part of the first attachment
        for k, of_part in enumerate(faces):
            for row, corner in enumerate(np.sort(s.conn[:, :corners], axis=1)):
                for element, loop in of_part.get(tuple(corner), ()):
                    nodes = solids[k].conn[element, list(loop)]
                    if _normals(X, nodes[None])[0] @ normal[row] > 0:
                        out[k][element, list(loop)] = back[nodes]
                        first = min(first or (row, k), (row, k))
        if first is not None:
            mine = np.zeros(len(X), bool)
            mine[s.conn] = True
            conn = solids[first[1]].conn
            out[first[1]] = np.where(mine[conn], back[conn], out[first[1]])
    return tuple(out)


def _normals(X: Floats, conn: Ints) -> Floats:
    """Normals (m, 3) of facets by their first three nodes."""
    a, b, c = X[conn[:, 0]], X[conn[:, 1]], X[conn[:, 2]]
    return np.cross(b - a, c - b)


def _faces(solid: Solid) -> dict[tuple[int, ...], list[tuple[int, tuple[int, ...]]]]:
    """Faces of a part by their sorted corner nodes: (element, local nodes)."""
    out: dict[tuple[int, ...], list[tuple[int, tuple[int, ...]]]] = {}
    for kind, loop in elements.get(solid.element).facets:
        corners = np.sort(solid.conn[:, loop[: elements.shape(kind).corners]], axis=1)
        for element, corner in enumerate(corners.tolist()):
            out.setdefault(tuple(corner), []).append((element, loop))
    return out
