"""The O-grid block: a rounded core, a cell, its pericellular matrix, and a way out to a box.

Hexahedra only. On a lattice of m_x x m_y x m_z the parameters s in [-1, 1]^3 become
t = tan(pi s / 4), so that the planes of the lattice cut the unit sphere at equal angles; n = t/|t|
are the directions. Layers grow from the core's skin along the directions to the cell's surface and
the PCM's, both exact at every node, and along straight lines to the skin of the block. Where the cell
lies off the PCM's middle, lines join points of one direction, so the PCM's nodes are those of any shift.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from febkit.model.mesh import Floats, Ints

from .cells import Chondron
from .lattice import grown, hexahedra, in_file_order, node_lattice, skin_index, skin_quads, spaced
from .parts import joined

# share of the cell's radius that the core takes, and how round the core's skin is (0 cube, 1 sphere)
CORE, ROUND = 0.5, 0.52


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """The connectivity of all blocks of one size."""

    parameters: Floats  # (node, 3) of the core's lattice, t in [-1, 1]^3
    skin: Ints  # (skin node,) rows of ``parameters``
    layers: tuple[int, int, int]
    cell: Ints
    pcm: Ints
    ecm: Ints

    @property
    def interior(self) -> int:
        """Nodes of a block without those of the box's skin."""
        return len(self.parameters) + (sum(self.layers) - 1) * len(self.skin)


def pattern(size: tuple[int, int, int], layers: tuple[int, int, int]) -> Pattern:
    """The connectivity of a block of ``size`` with ``layers`` in the cell, the PCM and beyond."""
    ids = node_lattice(size)
    at = np.stack(np.meshgrid(*(np.arange(m + 1) for m in size), indexing="ij"), axis=-1)
    s = 2.0 * in_file_order(at) / np.array(size) - 1.0
    index = skin_index(size)
    skin = ids[tuple(index.T)]
    rank = np.full(ids.size, -1, dtype=np.int64)
    rank[skin] = np.arange(len(skin))
    quads = ids[tuple(np.moveaxis(skin_quads(size)[0], -1, 0))]
    ranked, core = rank[quads], ids.size
    levels = [quads] + [core + layer * len(skin) + ranked for layer in range(sum(layers))]
    shells = [grown(a, b) for a, b in pairwise(levels)]
    first, second = layers[0], layers[0] + layers[1]
    cell = np.concatenate([in_file_order(hexahedra(ids)), *shells[:first]])
    return Pattern(np.tan(np.pi / 4.0 * s), skin, layers, cell, joined(shells[first:second], 8),
                   joined(shells[second:], 8))


def core_nodes(t: Floats, share: float = CORE, rounding: float = ROUND) -> Floats:
    """The core of the unit cell: the lattice between a cube (rounding 0) and a ball (rounding 1)."""
    reach = np.abs(t).max(axis=1, keepdims=True)
    n = unit(t)
    cube = t * np.sqrt(2.0 / 3.0)
    w = rounding * reach
    x: Floats = share * ((1.0 - w) * cube + w * reach * n)
    return x


def unit(t: Floats) -> Floats:
    """Directions (node, 3) of vectors; zero ones stay."""
    length = np.linalg.norm(t, axis=1, keepdims=True)
    n: Floats = t / np.where(length > 0, length, 1.0)
    return n


def block_nodes(p: Pattern, centre: Floats, chondron: Chondron, box: Floats, ratio: float) -> Floats:
    """Coordinates (node, 3) of a block's interior nodes, the PCM's middle at ``centre``.

    ``box`` (skin node, 3) are the box's nodes, ``ratio`` the last over the first thickness of the layers outside.
    """
    directions = unit(p.parameters)
    core = chondron.cell.surface(directions, core_nodes(p.parameters))
    n = directions[p.skin]
    stations = [core[p.skin], chondron.cell.surface(n), chondron.pcm.surface(n), box - centre]
    x: Floats = centre + np.concatenate([core, *between(stations, p.layers, (1.0, 1.0, ratio))[:-1]])
    return x


def between(stations: Sequence[Floats], layers: Sequence[int], ratios: Sequence[float]) -> list[Floats]:
    """Levels of nodes from each station to the next, the last of them the last station, the first left out."""
    levels = []
    for a, b, count, r in zip(stations[:-1], stations[1:], layers, ratios, strict=True):
        levels += [(1.0 - f) * a + f * b for f in spaced(0.0, 1.0, count, r)[1:]]
    return levels
