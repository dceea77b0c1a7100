"""Where the chondrons are: blocks of the background that hold one each, without overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from febkit.model import InputError
from febkit.model.mesh import Floats, Ints

from .cells import Chondron

TRIES, RESTARTS = 2000, 60


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Where the chondrons are: centres (chondron, 3), and the block of background elements each replaces."""

    centres: Floats
    start: Ints  # (chondron, 3) first lattice cell of the block
    size: Ints  # (chondron, 3) cells of the block along each axis


def half_extents(chondrons: Sequence[Chondron]) -> Floats:
    """Half the bounding box of each PCM (chondron, 3)."""
    return np.stack([c.pcm.half_extents() for c in chondrons])


def block_sizes(cells: Sequence[Chondron], h: float, block: int, room: float) -> Ints:
    """Background elements that each block spans (cell, 3): ``block``, or for 0 the least with room.

    A block's half edge is at least ``room`` times the PCM's half extent, about a row at least that of its width more.
    """
    if block:
        return block * steps(cells)
    half = half_extents(cells)
    rows = steps(cells)
    ends = (rows > 1).any(axis=1, keepdims=True)
    half = np.where(ends, half + (room - 1.0) * half.min(axis=1, keepdims=True), room * half)
    least = np.ceil(2.0 * half / h / rows - 1e-9)
    return (np.maximum(least, 3) * rows).astype(np.int64)


def steps(cells: Sequence[Chondron]) -> Ints:
    """What each block's sizes (cell, 3) are multiples of: along a row, its number of cells."""
    return np.array([[len(c.cells) if a == c.column else 1 for a in range(3)] for c in cells], dtype=np.int64)


def needed(cells: Sequence[Chondron], least: float) -> Floats:
    """Half edges (cell, 3) of the smallest block with the least gap, which goes by a row's width."""
    half = half_extents(cells)
    rows = (steps(cells) > 1).any(axis=1, keepdims=True)
    return np.where(rows, half + least * half.min(axis=1, keepdims=True), half * (1.0 + least))


def _fit(centre: Floats, size: Ints, half: Floats, edge: float, n: int, exact: bool) -> tuple[Floats, Ints]:
    """The block around a centre, and the centre moved (unless ``exact``) so that ``half`` lies inside."""
    h = edge / n
    start = np.rint((centre + edge / 2.0) / h - size / 2.0).astype(np.int64)
    middle = (start + size / 2.0) * h - edge / 2.0
    slack = size * h / 2.0 - half
    off = centre - middle
    if exact:
        return (centre, start) if (np.abs(off) <= slack + 1e-12).all() else (centre, start * 0 - 1)
    return middle + np.clip(off, -np.maximum(slack, 0.0), np.maximum(slack, 0.0)), start


def _inside(start: Ints, size: Ints, n: int, margin: int) -> bool:
    return bool((start >= margin).all() and (start + size <= n - margin).all())


def _free(start: Ints, size: Ints, others: Ints, other_sizes: Ints) -> bool:
    """True where a block shares no element with the others."""
    apart = (start >= others + other_sizes) | (others >= start + size)
    return bool(apart.any(axis=1).all())


def place_at_random(cells: Sequence[Chondron], size: Ints, edge: float, n: int, margin: int, least: float,
                    rng: np.random.Generator) -> Places:
    """Random centres by sequential addition, the largest block first; a jammed start is given up.

    Centres are uniform in the cube; a cell whose place is taken draws again.
    """
    count, half, h = len(cells), needed(cells, least), edge / n
    if (size * h / 2.0 < half - 1e-12).any():
        raise InputError(f"a block of {int(size.min())} background elements of {h:.4g} is too small for a "
                         f"cell with its PCM, which needs half a size of {half.max():.4g}; raise block (or leave "
                         "it 0), or lower n")
    order = np.argsort(-size.prod(axis=1), kind="stable")
    for _ in range(RESTARTS if size.prod(axis=1).sum() <= (n - 2 * margin) ** 3 else 0):
        centres, start = np.zeros((count, 3)), np.zeros((count, 3), dtype=np.int64)
        for done, c in enumerate(order):
            seen = order[:done]
            for _ in range(TRIES):
                drawn = rng.uniform(-edge / 2.0, edge / 2.0, 3)
                centres[c], start[c] = _fit(drawn, size[c], half[c], edge, n, exact=False)
                apart = _free(start[c], size[c], start[seen], size[seen])
                if apart and _inside(start[c], size[c], n, margin):
                    break
            else:
                break
        else:
            return Places(centres, start, size)
    raise InputError(f"no room for {count} cells: their blocks take {size.prod(axis=1).sum()} of {n**3} "
                     "background elements; use fewer or smaller cells, a finer background (n), "
                     "or a smaller margin")


def place_at(cells: Sequence[Chondron], centres: Any, size: Ints, edge: float, n: int, margin: int,
             least: float) -> Places:
    """Blocks around given centres (cell, 3), measured from the middle of the cube."""
    at = np.asarray(centres, dtype=float)
    if at.shape != (len(cells), 3):
        raise InputError(f"centres must hold {len(cells)} points x, y, z, not shape {at.shape}")
    half, size, step = needed(cells, least), size.copy(), steps(cells)
    start = np.zeros_like(size)
    for c in range(len(cells)):
        for more in range(3):
            _, start[c] = _fit(at[c], size[c] + more * step[c], half[c], edge, n, exact=True)
            if start[c].min() >= 0:
                size[c] += more * step[c]
                break
        if not _inside(start[c], size[c], n, max(margin, 0)):
            raise InputError(f"cell {c + 1} at {at[c].tolist()} does not fit in the cube of edge {edge}: its "
                             f"block leaves less than {margin} background elements to the cube's surface")
        if not _free(start[c], size[c], start[:c], size[:c]):
            raise InputError(f"the block around cell {c + 1} at {at[c].tolist()} overlaps another cell's; "
                             "move it away, or raise n so that blocks are closer to the cells")
    return Places(at, start, size)


def larger(edge: float, n: int, whole: float) -> tuple[float, int]:
    """Edge and background elements of the cube that cells are placed in: of this one's elements, about its middle.

    ``whole``: that cube's edge, 0 for the cube itself.
    """
    if not whole:
        return edge, n
    wide = round(whole / edge * n)
    if whole < edge * (1 - 1e-9) or abs(wide * edge / n - whole) > 1e-3 * edge / n or (wide - n) % 2:
        raise InputError(f"cut_from ({whole:g}) must be edge ({edge:g}) with a whole number of elements of edge/n = "
                         f"{edge / n:.6g} more on each side; {_near(edge, n, whole):.6g} is")
    return whole, wide


def _near(edge: float, n: int, whole: float) -> float:
    return edge + 2 * max(0, round((whole / edge - 1) * n / 2)) * edge / n


def cut(places: Places, wide: int, n: int, margin: int) -> tuple[Places, Ints]:
    """What lies in the middle ``n`` of ``wide`` background elements, nearest the middle first, and its cells.

    Near is by the half edge of the least cube around a block, so a cell has one number in cubes of any size.
    """
    start = places.start - (wide - n) // 2
    reach = np.maximum(np.abs(start - n / 2), np.abs(start + places.size - n / 2)).max(axis=1)
    order = np.argsort(reach, kind="stable")
    kept: Ints = order[reach[order] <= n / 2 - margin]
    if not len(kept):
        least = int(2 * (reach.min() + margin))
        raise InputError(f"none of the {len(order)} cells of the larger cube lies in this one, {margin} elements from "
                         f"its surface; the nearest does from n = {least} on, with elements of this size: take another "
                         "seed, or a larger cube")
    return Places(places.centres[kept], start[kept], places.size[kept]), kept
