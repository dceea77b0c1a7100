"""The cell cube: chondrocytes in their pericellular matrix inside a cube of extracellular matrix.

A uniform background of n^3 hexahedra; around each cell a block of them is replaced by an O-grid
whose skin keeps the background's nodes, so the mesh is conforming.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from febkit.model import InputError
from febkit.model.mesh import Floats, Ints

from .cells import Chondron, drawn_groups, make_chondrons
from .grouped import group_nodes, group_pattern
from .lattice import hexahedra, in_file_order, nodes_at, skin_index
from .ogrid import block_nodes, pattern, unit
from .parts import Parts, numbered
from .places import Places, block_sizes, cut, larger, place_at, place_at_random
from .quality import volumes
from .superellipsoids import Superellipsoid


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
    whole, wide = larger(edge, n, float(p["cut_from"]))
    rng = np.random.default_rng(int(p["seed"]))
    given = list(p["centres"])
    if p["density"] and not given:
        p = p | {"group": drawn_groups(float(p["density"]), whole**3, p["shares"], int(p["seed"]))}
    count = len(given) or (len(p["group"]) if isinstance(p["group"], list) else int(p["cells"]))
    cells = make_chondrons(p, count, rng)
    size = block_sizes(cells, edge / n, int(p["block"]), float(p["room"]))
    margin, least = int(p["margin"]), float(p["gap"])
    if given:
        places = place_at(cells, given, size, whole, wide, margin, least)
    else:
        places = place_at_random(cells, size, whole, wide, margin, least, rng)
    if p["cut_from"]:
        places, kept = cut(places, wide, n, margin)
        cells = [cells[c] for c in kept]
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
    pcm: list[Ints] = []
    within: list[Ints] = []
    first = len(lattice)
    for c, chondron in enumerate(cells):
        size = (int(places.size[c, 0]), int(places.size[c, 1]), int(places.size[c, 2]))
        box = ids[tuple((skin_index(size) + places.start[c]).T)]
        made = block(chondron, size, layers, places.centres[c], lattice[box], growth)
        X.append(made.X)
        number = np.concatenate([np.arange(first, first + len(made.X)), box])
        within += [number[conn] for conn in made.cells]
        pcm.append(number[made.pcm])
        ecm.append(number[made.ecm])
        first += len(made.X)
    parts = named(np.concatenate(ecm), pcm, within)
    return CellCube(Parts(np.concatenate(X), parts), cells, places, ids, edge)


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """A chondron's block: its nodes without those of the box's skin, which come after them in the connectivities."""

    X: Floats
    cells: tuple[Ints, ...]
    pcm: Ints
    ecm: Ints


def block(chondron: Chondron, size: tuple[int, int, int], layers: tuple[int, int, int], centre: Floats,
          box: Floats | Superellipsoid, growth: float) -> Block:
    """The O-grids of a chondron out to the nodes of a box, or to a body's surface, whose nodes then come with it."""
    count = len(chondron.cells)
    if count > 1:
        g = _group_pattern(size, layers, count, chondron.column)
        return Block(group_nodes(g, centre, chondron, box, growth), g.cells, g.pcm, g.ecm)
    p = _pattern(size, layers)
    skin = box.surface(unit(p.parameters[p.skin])) if isinstance(box, Superellipsoid) else box
    X = block_nodes(p, centre, chondron, skin, growth)
    if isinstance(box, Superellipsoid):
        X = np.concatenate([X, skin])
    return Block(X, (p.cell,), p.pcm, p.ecm)


def named(ecm: Ints, pcm: list[Ints], cells: list[Ints]) -> dict[str, tuple[str, Ints]]:
    """Parts ecm, pcm_1, ..., cell_1, ... of hexahedra."""
    names = ["ecm", *numbered("pcm", len(pcm)), *numbered("cell", len(cells))]
    return {name: ("hex8", conn) for name, conn in zip(names, [ecm, *pcm, *cells], strict=True)}


_pattern = lru_cache(maxsize=16)(pattern)
_group_pattern = lru_cache(maxsize=16)(group_pattern)


def volume_report(mesh: Parts, cells: list[Chondron], exactly: float, whole: float = 0.0) -> dict[str, float]:
    """Volume fractions of cells and PCM, by the mesh and exactly; the PCM's thickness.

    ``exactly`` is the volume of all, ``whole`` that of the mesh where it is another.
    """
    got: dict[str, float] = {"cell": 0.0, "pcm": 0.0}
    for name, (kind, conn) in mesh.parts.items():
        role = name.partition("_")[0]
        if role in got:
            got[role] += float(volumes(mesh.X, kind, conn).sum())
    whole = whole or exactly
    exact: Floats = np.array([c.volumes for c in cells]).sum(axis=0)
    thickness = [c.thickness for c in cells]
    return {
        "cell volume fraction": got["cell"] / whole,
        "exact cell volume fraction": float(exact[0]) / exactly,
        "PCM volume fraction": got["pcm"] / whole,
        "exact PCM volume fraction": float(exact[1]) / exactly,
        "ECM volume fraction": 1.0 - (got["cell"] + got["pcm"]) / whole,
        "thinnest PCM": min(t for t, _ in thickness),
        "thickest PCM": max(t for _, t in thickness),
    }
