"""Structured lattices of nodes: their cells, their skins, and the layers that grow from a skin."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from febkit.model.mesh import Floats, Ints

Item = TypeVar("Item", bound=np.generic)

_CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


def node_lattice(cells: tuple[int, int, int], first: int = 0) -> Ints:
    """Node numbers (i, j, k) of a lattice with that many cells a side; i runs fastest."""
    nx, ny, nz = (n + 1 for n in cells)
    return (np.arange(nx * ny * nz, dtype=np.int64) + first).reshape(nz, ny, nx).transpose(2, 1, 0)


def hexahedra(ids: Ints) -> Ints:
    """Hexahedra (i, j, k, 8) between the nodes of a lattice, in FEBio's node order."""
    nx, ny, nz = (n - 1 for n in ids.shape)
    conn: Ints = np.stack([ids[a:a + nx, b:b + ny, c:c + nz] for a, b, c in _CORNERS], axis=-1)
    return conn


def in_file_order(per_cell: NDArray[Item]) -> NDArray[Item]:
    """(i, j, k, ...) flattened to rows with i running fastest."""
    return per_cell.swapaxes(0, 2).reshape(-1, *per_cell.shape[3:])


def nodes_at(x: Floats, y: Floats, z: Floats) -> Floats:
    """Coordinates (node, 3) of the tensor-product lattice of three sets of planes, x fastest."""
    Z, Y, X = np.meshgrid(z, y, x, indexing="ij")
    return np.stack([X.ravel(), Y.ravel(), Z.ravel()], axis=1)


def skin_index(cells: tuple[int, int, int]) -> Ints:
    """Lattice positions (node, 3) of the outermost nodes, i fastest."""
    nx, ny, nz = cells
    k, j, i = np.meshgrid(np.arange(nz + 1), np.arange(ny + 1), np.arange(nx + 1), indexing="ij")
    at = np.stack([i.ravel(), j.ravel(), k.ravel()], axis=1)
    outermost: Ints = at[((at == 0) | (at == np.array(cells))).any(axis=1)]
    return outermost


def skin_quads(cells: tuple[int, int, int]) -> tuple[Ints, Ints]:
    """Outward quads of a lattice's skin as lattice positions (quad, 4, 3), and the axis each faces."""
    quads, normals = [], []
    for axis in range(3):
        b, c = (axis + 1) % 3, (axis + 2) % 3
        u, v = np.meshgrid(np.arange(cells[b]), np.arange(cells[c]), indexing="ij")
        ring = np.zeros((u.size, 4, 3), dtype=np.int64)
        for local, (du, dv) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
            ring[:, local, b] = u.ravel() + du
            ring[:, local, c] = v.ravel() + dv
        far = ring.copy()
        far[:, :, axis] = cells[axis]
        quads += [ring[:, ::-1], far]
        normals.append(np.full(2 * u.size, axis))
    return np.concatenate(quads), np.concatenate(normals)


def grown(inner: Ints, outer: Ints) -> Ints:
    """Hexahedra between outward quads and their images one layer further out."""
    return np.concatenate([inner, outer], axis=1)


def spaced(start: float, stop: float, n: int, ratio: float = 1.0) -> Floats:
    """n + 1 positions whose steps grow geometrically; ``ratio`` is the last step over the first."""
    if n < 1:
        return np.array([start])
    steps = np.geomspace(1.0, ratio, n) if n > 1 else np.ones(1)
    at = np.concatenate([[0.0], np.cumsum(steps)])
    x: Floats = start + (stop - start) * at / at[-1]
    x[-1] = stop
    return x
