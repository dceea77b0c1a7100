"""The block of a chondron with several cells: an O-grid about each in a common cradle, an O-grid about the cradle.

The block's lattice is cut into as many pieces along the row as there are cells. The skins of the pieces make the
cradle: part of the way from the cells to the PCM's surface, round at the row's ends, discs between neighbours. Inside
each piece a cell is meshed as one alone is; from the cradle's skin layers grow away from the row's axis to the PCM's
surface and on.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from febkit.model import InputError
from febkit.model.mesh import Floats, Ints

from .cells import Chondron
from .lattice import grown, node_lattice, skin_index, skin_quads
from .ogrid import Pattern, between, core_nodes, pattern, unit
from .parts import joined
from .superellipsoids import Superellipsoid

# the cradle's distance from the cells over the PCM's thickness, and how round it is: for the best worst scaled Jacobian
SHARE, ROUND = 0.35, 0.85


@dataclass(frozen=True, slots=True, eq=False)
class GroupPattern:
    """Connectivity of a block of several cells; its own nodes come in this order, those of the box's skin last:
    pieces without their skins, the cradle, and the layers outside it.
    """

    pieces: tuple[Pattern, ...]
    places: tuple[Ints, ...]  # rows of the cradle's nodes that are each piece's skin
    cradle: int  # number of the cradle's nodes
    skin: Ints  # rows of the cradle's nodes on the block's skin, in the order of ``skin_index``
    layers: tuple[int, int]  # outside of the cradle: of PCM, and beyond
    cells: tuple[Ints, ...]
    pcm: Ints
    ecm: Ints

    @property
    def interior(self) -> int:
        """Nodes of a block without those of the box's skin."""
        return sum(p.interior for p in self.pieces) + self.cradle + (sum(self.layers) - 1) * len(self.skin)


def group_pattern(size: tuple[int, int, int], layers: tuple[int, int, int], cells: int, axis: int) -> GroupPattern:
    """The connectivity of a block of ``size``, a multiple of ``cells`` along ``axis``."""
    inside, outside = max(1, layers[1] // 2), max(1, layers[1] - layers[1] // 2)
    m = size[axis] // cells
    piece_size = tuple(m if a == axis else n for a, n in enumerate(size))
    one = pattern((piece_size[0], piece_size[1], piece_size[2]), (layers[0], inside, 0))
    index = skin_index((piece_size[0], piece_size[1], piece_size[2]))
    ids = node_lattice(size)
    on = [ids[tuple((index + m * c * np.eye(3, dtype=np.int64)[axis]).T)] for c in range(cells)]
    kept = np.unique(np.concatenate(on))
    places = tuple(np.searchsorted(kept, rows) for rows in on)
    skin = np.searchsorted(kept, ids[tuple(skin_index(size).T)])
    first = cells * one.interior
    parts: list[Ints] = []
    pcm: list[Ints] = []
    for c in range(cells):
        number = np.concatenate([np.arange(one.interior) + c * one.interior, first + places[c]])
        parts.append(number[one.cell])
        pcm.append(number[one.pcm])
    rank = np.full(ids.size, -1, dtype=np.int64)
    rank[ids[tuple(skin_index(size).T)]] = np.arange(len(skin))
    ranked = rank[ids[tuple(np.moveaxis(skin_quads(size)[0], -1, 0))]]
    levels = [first + skin[ranked]] + [first + len(kept) + k * len(skin) + ranked for k in range(outside + layers[2])]
    shells = [grown(a, b) for a, b in pairwise(levels)]
    return GroupPattern((one,) * cells, places, len(kept), skin, (outside, layers[2]), tuple(parts),
                        np.concatenate(pcm + shells[:outside]), joined(shells[outside:], 8))


def group_nodes(p: GroupPattern, centre: Floats, chondron: Chondron, box: Floats | Superellipsoid,
                ratio: float) -> Floats:
    """Coordinates (node, 3) of a block's nodes about ``centre``, and of a body's surface where that is the ``box``."""
    cradle = np.empty((p.cradle, 3))
    for c, rows in enumerate(p.places):
        cradle[rows] = _cradle(p.pieces[c], chondron, c)
    inner = []
    for piece, cell, rows in zip(p.pieces, chondron.cells, p.places, strict=True):
        directions = unit(piece.parameters)
        core = cell.surface(directions, core_nodes(piece.parameters))
        stations = [core[piece.skin], cell.surface(directions[piece.skin]), cradle[rows]]
        inner += [core, *between(stations, piece.layers[:2], (1.0, 1.0))[:-1]]
    x = cradle[p.skin]
    if (chondron.pcm.gauge(x) >= 1.0).any():
        raise InputError("the PCM leaves a row of cells too little room at its ends; raise thickness or pcm_squareness")
    pcm = _hit(x, x, chondron, chondron.pcm)
    last = _hit(pcm, x, chondron, box) if isinstance(box, Superellipsoid) else box - centre
    outer = between([x, pcm, last], p.layers, (1.0, ratio))
    if not isinstance(box, Superellipsoid):
        outer = outer[:-1]
    made: Floats = centre + np.concatenate([*inner, cradle, *outer])
    return made


def _cradle(piece: Pattern, chondron: Chondron, number: int) -> Floats:
    """Skin (node, 3) of a cell's piece: a flat disc towards each neighbour, round at the row's ends."""
    cell, axis = chondron.cells[number], chondron.column
    t = piece.parameters[piece.skin]
    step = abs(float((chondron.cells[1].centre - chondron.cells[0].centre)[axis]))
    reach = cell.semi_axes + SHARE * _thickness(chondron)
    face = (1.0 - ROUND) * np.sqrt(2.0 / 3.0) + ROUND  # of the core's map, at the middle of a face
    toward = (t[:, axis] > 0) & (number < len(chondron.cells) - 1) | (t[:, axis] < 0) & (number > 0)
    level = t.copy()
    level[toward, axis] = 0.0
    x: Floats = core_nodes(level, 1.0 / face, ROUND) * reach
    x[toward, axis] = t[toward, axis] * step / 2.0
    return x + cell.centre


def _thickness(chondron: Chondron) -> Floats:
    """PCM's thickness (3,) beyond the row along the axes."""
    ends = np.abs(chondron.cells[-1].centre)
    t: Floats = chondron.pcm.semi_axes - chondron.cell.semi_axes - ends
    return t


def _hit(start: Floats, x: Floats, chondron: Chondron, body: Superellipsoid) -> Floats:
    """Where rays that pass through ``x`` away from the row's axis leave a body, from ``start`` inside it."""
    axis, ends = chondron.column, [c.centre[chondron.column] for c in chondron.cells]
    away = x.copy()
    away[:, axis] -= np.clip(x[:, axis], min(ends), max(ends))
    far = 10.0 * float(body.semi_axes.max() / np.linalg.norm(away, axis=1).min())
    low, high = np.zeros(len(x)), np.full(len(x), far)
    for _ in range(60):
        middle = (low + high) / 2.0
        inside = body.gauge(start + middle[:, None] * away) < 1.0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    found: Floats = start + low[:, None] * away
    return found
