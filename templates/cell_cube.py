"""The cell cube: chondrocytes in their pericellular matrix inside a cube of extracellular matrix.

A uniform background of n^3 hexahedra; around each cell a block of them is replaced by an O-grid
whose skin keeps the background's nodes, so the mesh is conforming.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from febkit.model import InputError
from febkit.model.mesh import Floats, Ints

from .cells import Chondron, make_chondrons
from .lattice import hexahedra, in_file_order, nodes_at, skin_index
from .ogrid import Pattern, block_nodes, pattern
from .parts import Parts, numbered
from .places import Places, block_sizes, place_at, place_at_random
from .quality import volumes


@dataclass(frozen=True, slots=True, eq=False)
class CellCube:
    """The mesh, its cells and places, and the node number (n+1, n+1, n+1) of each background node.

    Background nodes swallowed by a block are -1; the skin of the cube is always there.
    """

    mesh: Parts
    cells: list[Chondron]
    places: Places
    background: Ints
    edge: float


def cell_cube(p: dict[str, Any]) -> CellCube:
    """Build the cube from the template's parameters (see templates/cell/template.toml)."""
    n, edge = int(p["n"]), float(p["edge"])
    layers = (int(p["layers"][0]), int(p["layers"][1]), int(p["layers"][2]))
    if min(layers) < 1:
        raise InputError(f"layers must be three numbers from 1 (cell, PCM, around), not {list(p['layers'])}")
    rng = np.random.default_rng(int(p["seed"]))
    given = list(p["centres"])
    count = len(given) if given else int(p["cells"])
    cells = make_chondrons(p, count, rng)
    size = block_sizes(cells, edge / n, int(p["block"]), float(p["room"]))
    margin, least = int(p["margin"]), float(p["gap"])
    if given:
        places = place_at(cells, given, size, edge, n, margin, least)
    else:
        places = place_at_random(cells, size, edge, n, margin, least, rng)
    return _assemble(cells, places, edge, n, layers, float(p["growth"]))


def _background(places: Places, n: int) -> tuple[Ints, Ints]:
    """Node numbers of the background (-1 where a block swallowed the node), and its elements kept."""
    node = np.ones((n + 1,) * 3, dtype=bool)
    element = np.ones((n,) * 3, dtype=bool)
    for start, size in zip(places.start, places.size, strict=True):
        (a, b, c), (d, e, f) = start, start + size
        element[a:d, b:e, c:f] = False
        node[a + 1:d, b + 1:e, c + 1:f] = False
    ids = np.full(node.shape, -1, dtype=np.int64)
    ids.swapaxes(0, 2)[node.swapaxes(0, 2)] = np.arange(int(node.sum()))
    conn = in_file_order(hexahedra(ids))
    return ids, conn[in_file_order(element)]


def _assemble(cells: list[Chondron], places: Places, edge: float, n: int, layers: tuple[int, int, int],
              growth: float) -> CellCube:
    """Number the nodes (background first, then cell by cell) and gather the parts."""
    ids, kept = _background(places, n)
    planes = np.linspace(-edge / 2.0, edge / 2.0, n + 1)
    lattice = nodes_at(planes, planes, planes)[in_file_order(ids >= 0)]
    X, ecm = [lattice], [kept]
    shells: dict[str, Ints] = {}
    patterns: dict[tuple[int, int, int], Pattern] = {}
    first = len(lattice)
    for c in range(len(cells)):
        size = (int(places.size[c, 0]), int(places.size[c, 1]), int(places.size[c, 2]))
        p = patterns.setdefault(size, pattern(size, layers))
        box = ids[tuple((skin_index(size) + places.start[c]).T)]
        X.append(block_nodes(p, places.centres[c], cells[c], lattice[box], growth))
        number = np.concatenate([np.arange(first, first + p.interior), box])
        shells[f"cell_{c + 1}"], shells[f"pcm_{c + 1}"] = number[p.cell], number[p.pcm]
        ecm.append(number[p.ecm])
        first += p.interior
    names = numbered("pcm", len(cells)) + numbered("cell", len(cells))
    parts = {"ecm": ("hex8", np.concatenate(ecm))} | {name: ("hex8", shells[name]) for name in names}
    return CellCube(Parts(np.concatenate(X), parts), cells, places, ids, edge)


def volume_report(mesh: Parts, cells: list[Chondron], exactly: float) -> dict[str, float]:
    """Volume fractions of cells and PCM, by the mesh and of the exact volume ``exactly``; the PCM's thickness."""
    got: dict[str, float] = {"cell": 0.0, "pcm": 0.0, "ecm": 0.0, "tissue": 0.0}
    for name, (kind, conn) in mesh.parts.items():
        got[name.partition("_")[0]] += float(volumes(mesh.X, kind, conn).sum())
    whole = got["cell"] + got["pcm"] + got["ecm"]
    exact: Floats = np.array([c.volumes for c in cells]).sum(axis=0)
    thickness = [c.thickness for c in cells]
    return {
        "cell volume fraction": got["cell"] / whole,
        "exact cell volume fraction": float(exact[0]) / exactly,
        "PCM volume fraction": got["pcm"] / whole,
        "exact PCM volume fraction": float(exact[1]) / exactly,
        "ECM volume fraction": got["ecm"] / whole,
        "thinnest PCM": min(t for t, _ in thickness),
        "thickest PCM": max(t for _, t in thickness),
    }
