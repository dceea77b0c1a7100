"""The embedded control: the cell cube merged, node for node, into the middle of the tissue cube.

Nodes and elements of the cell cube come first and keep their numbers. Around it either three layers
that coarsen three to one and then a grid whose planes beyond the coarsened region are the tissue
model's own in z, or (``transition = "none"``) a grid that carries on the cell cube's planes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from febkit.model import InputError
from febkit.model.mesh import Floats, Ints

from .cell_cube import CellCube, cell_cube
from .coarsening import Skin, around
from .lattice import hexahedra, in_file_order, nodes_at, spaced
from .parts import Parts


@dataclass(frozen=True, slots=True, eq=False)
class EmbeddedCube:
    mesh: Parts
    inner: CellCube
    edge: float


def embedded_cube(p: dict[str, Any]) -> EmbeddedCube:
    """Build the control from the template's parameters (see templates/embedded/template.toml)."""
    cube = cell_cube(p)
    edge, centre, n = float(p["tissue_edge"]), float(p["centre"]), int(p["n"])
    if not cube.edge < centre < edge:
        raise InputError(f"centre ({centre}) must lie between the cell cube's edge ({cube.edge}) "
                         f"and the tissue's ({edge})")
    skin = Skin((n, n, n), cube.edge / 2.0, cube.background)
    X, conn = [cube.mesh.X], []
    if p["transition"] == "3:1":
        if n % 3:
            raise InputError(f'n = {n} must be a multiple of 3 for transition = "3:1"; or set it to "none"')
        layers, skin = around(skin, centre / 2.0, len(cube.mesh.X))
        X += [layer.X for layer in layers]
        conn += [layer.conn for layer in layers]
    lateral = _planes(skin, edge, int(p["lateral"]), float(p["grading"]))
    vertical = _planes(skin, edge, int(p["vertical"]), float(p["grading"]))
    grid, elements = _frame(skin, (lateral, lateral, vertical), sum(map(len, X)))
    X.append(grid)
    conn.append(elements)
    parts = dict(cube.mesh.parts) | {"tissue": ("hex8", np.concatenate(conn))}
    return EmbeddedCube(Parts(np.concatenate(X), parts), cube, edge)


def _planes(skin: Skin, edge: float, layers: int, ratio: float) -> Floats:
    """Planes across the tissue: ``layers`` on each side of those of the region in the middle."""
    side = spaced(skin.half, edge / 2.0, layers, ratio)[1:]
    middle = np.linspace(-skin.half, skin.half, skin.cells[0] + 1)
    return np.concatenate([-side[::-1], middle, side])


def _frame(skin: Skin, planes: tuple[Floats, Floats, Floats], first: int) -> tuple[Floats, Ints]:
    """Grid nodes and elements around the skin's box, which keeps its own nodes."""
    low = [(len(p) - 1 - m) // 2 for p, m in zip(planes, skin.cells, strict=True)]
    shape = tuple(len(p) for p in planes)
    node = np.ones(shape, dtype=bool)
    element = np.ones(tuple(m - 1 for m in shape), dtype=bool)
    box = tuple(slice(a, a + m + 1) for a, m in zip(low, skin.cells, strict=True))
    node[box] = False
    element[tuple(slice(a, a + m) for a, m in zip(low, skin.cells, strict=True))] = False
    number = np.full(shape, -1, dtype=np.int64)
    number.swapaxes(0, 2)[node.swapaxes(0, 2)] = np.arange(first, first + int(node.sum()))
    number[box] = skin.number
    X = nodes_at(*planes)[in_file_order(node)]
    return X, in_file_order(hexahedra(number))[in_file_order(element)]
