"""Layers around a lattice's skin that take three elements to one, axis by axis, in hexahedra.

In a layer that coarsens along x, the faces parallel to x carry the pattern of four quadrilaterals that
joins three edges to one, swept along the other direction of the face; the two faces across x carry a
plain layer. An edge of the skin along x lies between two faces that both coarsen, an edge along y
or z between two that do not coarsen in that direction, so the layer conforms everywhere. Three such
layers, along x, y and z, take n x n quadrilaterals on each face to n/3 x n/3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from febkit.model.mesh import Floats, Ints

from .lattice import grown, skin_index, skin_quads

# height of a layer over the coarse element's width, and of the pattern's inner nodes within the layer:
# chosen for the best worst scaled Jacobian (0.30) at 12 to 36 elements an edge
HEIGHT, RISE = 0.6, 0.6


@dataclass(frozen=True, slots=True, eq=False)
class Skin:
    """The skin of a lattice of ``cells`` in a box of half edge ``half``.

    ``number`` (i, j, k) holds node numbers on the skin, -1 inside.
    """

    cells: tuple[int, int, int]
    half: float
    number: Ints

    def positions(self) -> Floats:
        """Coordinates (node, 3) of the skin's nodes in the order of ``skin_index``."""
        x: Floats = skin_index(self.cells) * (2.0 * self.half / np.array(self.cells)) - self.half
        return x


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    X: Floats  # coordinates of the new nodes
    conn: Ints  # (element, 8)
    skin: Skin  # the new skin


def _new_skin(cells: tuple[int, int, int], half: float, first: int) -> Skin:
    index = skin_index(cells)
    number = np.full(tuple(m + 1 for m in cells), -1, dtype=np.int64)
    number[tuple(index.T)] = np.arange(first, first + len(index))
    return Skin(cells, half, number)


def around(skin: Skin, half: float, first: int) -> tuple[list[Layer], Skin]:
    """Three coarsening layers and plain ones from a skin out to a box of half edge ``half``.

    Plain layers are about as thick as their elements are wide.
    """
    layers = []
    rise, room = HEIGHT * 6.0 * skin.half / skin.cells[0], half - skin.half
    if room - 3.0 * rise < 3.0 * half / skin.cells[0]:  # what is left is no layer: fill the room
        rise = room / 3.0
    for axis in range(3):
        last = axis == 2 and half - skin.half - rise < 1e-9 * half
        layers.append(coarsen(skin, axis, half if last else skin.half + rise, first))
        first, skin = first + len(layers[-1].X), layers[-1].skin
    if skin.half < half:
        count = max(1, round(np.log(half / skin.half) / np.log(1.0 + 2.0 / skin.cells[0])))
        for outer in [*np.geomspace(skin.half, half, count + 1)[1:-1].tolist(), half]:
            layers.append(plain(skin, outer, first))
            first, skin = first + len(layers[-1].X), layers[-1].skin
    return layers, skin


def plain(inner: Skin, half: float, first: int) -> Layer:
    """One layer to a box of half edge ``half`` that keeps the skin's elements."""
    outer = _new_skin(inner.cells, half, first)
    at = tuple(np.moveaxis(skin_quads(inner.cells)[0], -1, 0))
    return Layer(outer.positions(), grown(inner.number[at], outer.number[at]), outer)


def coarsen(inner: Skin, axis: int, half: float, first: int) -> Layer:
    """One layer from ``inner`` to a box of half edge ``half`` with a third of the elements along ``axis``.

    New nodes are numbered from ``first``: the new skin's, then those within the layer.
    """
    cells = list(inner.cells)
    cells[axis] //= 3
    outer = _new_skin((cells[0], cells[1], cells[2]), half, first)
    index = skin_index(inner.cells)
    between = index[index[:, axis] % 3 != 0]
    ends = index[index[:, axis] % 3 == 0]
    skin_x = outer.positions()
    lift = np.full_like(inner.number, -1)
    coarse = ends.copy()
    coarse[:, axis] //= 3
    lift[tuple(ends.T)] = outer.number[tuple(coarse.T)]
    lift[tuple(between.T)] = np.arange(len(between)) + first + len(skin_x)
    low = between * (2.0 * inner.half / np.array(inner.cells)) - inner.half
    inner_x = (1.0 - RISE) * low + RISE * low * (half / inner.half)
    quads, normal = skin_quads(inner.cells)
    at = tuple(np.moveaxis(quads, -1, 0))
    conn = [grown(inner.number[at], lift[at])]
    crown = quads[(normal != axis) & (quads[..., axis].min(axis=1) % 3 == 1)]
    cap = crown.copy()
    cap[..., axis] = np.where(crown[..., axis] % 3 == 1, crown[..., axis] // 3, crown[..., axis] // 3 + 1)
    conn.append(grown(lift[tuple(np.moveaxis(crown, -1, 0))], outer.number[tuple(np.moveaxis(cap, -1, 0))]))
    return Layer(np.concatenate([skin_x, inner_x]), np.concatenate(conn), outer)
