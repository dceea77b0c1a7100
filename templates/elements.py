"""A lattice of cubes filled with elements of other types: FEBio's node order, in half steps of a cube."""

from __future__ import annotations

import numpy as np

from febkit.model.mesh import Floats, Ints

from .lattice import in_file_order, node_lattice, nodes_at

_CORNERS = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [2, 2, 2], [0, 2, 2]])
_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
_FACES = ((0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (0, 1, 2, 3), (4, 5, 6, 7))
# six tetrahedra around the diagonal 0-6, two wedges beside the plane 0-2-6-4: conforming from cube to cube
_TETS = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_WEDGES = ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))


def _with_middles(corners: Ints, groups: tuple[tuple[int, ...], ...]) -> Ints:
    """Corners (..., corner, 3) followed by the middles of groups of them."""
    middles = [corners[..., list(g), :].sum(axis=-2) // len(g) for g in groups]
    return np.concatenate([corners, np.stack(middles, axis=-2)], axis=-2)


_HEX20 = _with_middles(_CORNERS[None], _EDGES)
_HEX27 = np.concatenate([_HEX20, _with_middles(_CORNERS[None], (*_FACES, tuple(range(8))))[:, 8:]], axis=1)
# element type: positions (element of a cube, local node, 3)
FILLS: dict[str, Ints] = {
    "hex8": _CORNERS[None], "hex20": _HEX20, "hex27": _HEX27, "tet4": _CORNERS[np.array(_TETS)],
    "tet10": _with_middles(_CORNERS[np.array(_TETS)], TET_EDGES), "penta6": _CORNERS[np.array(_WEDGES)],
}


def filled(planes: tuple[Floats, Floats, Floats], kind: str) -> tuple[Floats, Ints]:
    """Nodes (node, 3) and elements (element, local) of a box between these planes in x, y and z."""
    halves = []
    for p in planes:
        halves.append(np.empty(2 * len(p) - 1))
        halves[-1][::2], halves[-1][1::2] = p, (p[:-1] + p[1:]) / 2.0
    nx, ny, nz = (len(h) - 1 for h in halves)
    ids = node_lattice((nx, ny, nz))
    at = np.stack(np.meshgrid(*[np.arange(0, n, 2) for n in (nx, ny, nz)], indexing="ij"), axis=-1)
    corner = in_file_order(at)[:, None, None] + FILLS[kind]  # (cube, element, local, 3)
    conn = ids[tuple(np.moveaxis(corner, -1, 0))].reshape(-1, FILLS[kind].shape[1])
    used = np.zeros(ids.size, dtype=bool)
    used[conn] = True
    number = np.cumsum(used) - 1
    return nodes_at(*halves)[used], number[conn]
