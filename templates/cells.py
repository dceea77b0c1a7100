"""Chondrocytes with their pericellular matrix: sizes, orientations, and places without overlap."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from febkit.model import InputError
from febkit.model.mesh import Floats, Ints

TRIES, RESTARTS = 2000, 60


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Ellipsoids: semi-axes of the cells (cell, 3), PCM thickness (cell,), rotations (cell, 3, 3).

    The PCM's outer surface is the ellipsoid of semi-axes a + thickness on the same axes (for a
    sphere: the parallel surface). Lengths are the model's own (mm in the study).
    """

    semi_axes: Floats
    thickness: Floats
    rotation: Floats

    def __len__(self) -> int:
        return len(self.thickness)

    def stretch(self, cell: int, offset: float = 0.0) -> Floats:
        """Symmetric tensor R diag(a + offset) R^T that maps the unit sphere to a cell's ellipsoid."""
        R = self.rotation[cell]
        s: Floats = (R * (self.semi_axes[cell] + offset)) @ R.T
        return s

    def half_extents(self) -> Floats:
        """Half the bounding box of each PCM (cell, 3)."""
        outer = self.semi_axes + self.thickness[:, None]
        e: Floats = np.linalg.norm(self.rotation * outer[:, None, :], axis=2)
        return e

    def volumes(self) -> tuple[Floats, Floats]:
        """Volumes of the cells and of their PCM, 4/3 pi abc (cell,)."""
        inner = 4.0 / 3.0 * np.pi * self.semi_axes.prod(axis=1)
        outer = 4.0 / 3.0 * np.pi * (self.semi_axes + self.thickness[:, None]).prod(axis=1)
        return inner, outer - inner


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Where the cells are: centres (cell, 3), and the block of background elements each replaces."""

    centres: Floats
    start: Ints  # (cell, 3) first lattice cell of the block
    size: Ints  # (cell, 3) cells of the block along each axis


def make_cells(count: int, diameter: Any, thickness: Any, orientation: Any,
               rng: np.random.Generator) -> Cells:
    """Cells from what a user may say: one size for all, one for each, or three diameters for each."""
    d = np.asarray(diameter, dtype=float)
    if d.ndim == 0 or d.shape == (1,):
        axes = np.full((count, 3), float(d.reshape(-1)[0]))
    elif d.shape == (count,):
        axes = np.repeat(d[:, None], 3, axis=1)
    elif d.shape == (count, 3):
        axes = d
    else:
        raise InputError(f"diameter must be one length, {count} lengths, or {count} triples "
                         f"(one entry for each cell), not an array of shape {d.shape}")
    t = np.asarray(thickness, dtype=float)
    if t.size not in (1, count):
        raise InputError(f"thickness must be one length or {count}, not {t.size}")
    if (axes <= 0).any() or (t <= 0).any():
        raise InputError("diameters and thicknesses must be positive")
    thick = np.broadcast_to(t.reshape(-1), (count,)).copy()
    return Cells(axes / 2.0, thick, _rotations(count, orientation, rng))


def _rotations(count: int, orientation: Any, rng: np.random.Generator) -> Floats:
    """Rotation matrices: "aligned" with the axes, "random", or given as rotation vectors (radians)."""
    if isinstance(orientation, str):
        if orientation == "aligned":
            return np.tile(np.eye(3), (count, 1, 1))
        if orientation == "random":
            q, r = np.linalg.qr(rng.standard_normal((count, 3, 3)))
            q = q * np.sign(np.einsum("cii->ci", r))[:, None, :]
            q[np.linalg.det(q) < 0, :, 0] *= -1.0
            return np.asarray(q)
        raise InputError(f'orientation must be "aligned", "random" or rotation vectors, not "{orientation}"')
    v = np.asarray(orientation, dtype=float)
    if v.shape != (count, 3):
        raise InputError(f"orientation must hold {count} rotation vectors (radians), not shape {v.shape}")
    angle = np.linalg.norm(v, axis=1)
    k = v / np.where(angle > 0, angle, 1.0)[:, None]
    K = np.zeros((count, 3, 3))
    K[:, 0, 1], K[:, 0, 2], K[:, 1, 2] = -k[:, 2], k[:, 1], -k[:, 0]
    K -= K.swapaxes(1, 2).copy()
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    rotation: Floats = np.eye(3) + s * K + (1.0 - c) * (K @ K)
    return rotation


def block_sizes(cells: Cells, h: float, block: int, room: float) -> Ints:
    """Background elements that each block spans (cell, 3): ``block``, or for 0 the least with room.

    A block's half edge is at least ``room`` times the PCM's half extent.
    """
    if block:
        return np.full((len(cells), 3), block, dtype=np.int64)
    least = np.ceil(2.0 * room * cells.half_extents() / h - 1e-9)
    return np.maximum(least, 3).astype(np.int64)


def _fit(centre: Floats, size: Ints, extent: Floats, edge: float, n: int, least: float,
         exact: bool) -> tuple[Floats, Ints]:
    """The block around a centre, and the centre moved (unless ``exact``) to keep the least gap."""
    h = edge / n
    start = np.rint((centre + edge / 2.0) / h - size / 2.0).astype(np.int64)
    middle = (start + size / 2.0) * h - edge / 2.0
    slack = size * h / 2.0 - extent * (1.0 + least)
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


def place_at_random(cells: Cells, size: Ints, edge: float, n: int, margin: int, least: float,
                    rng: np.random.Generator) -> Places:
    """Random centres by sequential addition, the largest block first; a jammed start is given up.

    Centres are uniform in the cube; a cell whose place is taken draws again.
    """
    count, extents, h = len(cells), cells.half_extents(), edge / n
    if (size * h / 2.0 < extents * (1.0 + least) - 1e-12).any():
        raise InputError(f"a block of {int(size.min())} background elements of {h:.4g} is too small for a "
                         f"cell with its PCM of half size {extents.max():.4g}; raise block (or leave it 0), "
                         "or lower n")
    order = np.argsort(-size.prod(axis=1), kind="stable")
    for _ in range(RESTARTS if size.prod(axis=1).sum() <= (n - 2 * margin) ** 3 else 0):
        centres, start = np.zeros((count, 3)), np.zeros((count, 3), dtype=np.int64)
        for done, c in enumerate(order):
            seen = order[:done]
            for _ in range(TRIES):
                drawn = rng.uniform(-edge / 2.0, edge / 2.0, 3)
                centres[c], start[c] = _fit(drawn, size[c], extents[c], edge, n, least, exact=False)
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


def place_at(cells: Cells, centres: Any, size: Ints, edge: float, n: int, margin: int,
             least: float) -> Places:
    """Blocks around given centres (cell, 3), measured from the middle of the cube."""
    at = np.asarray(centres, dtype=float)
    if at.shape != (len(cells), 3):
        raise InputError(f"centres must hold {len(cells)} points x, y, z, not shape {at.shape}")
    extents, size = cells.half_extents(), size.copy()
    start = np.zeros_like(size)
    for c in range(len(cells)):
        for more in range(3):
            _, start[c] = _fit(at[c], size[c] + more, extents[c], edge, n, least, exact=True)
            if start[c].min() >= 0:
                size[c] += more
                break
        if not _inside(start[c], size[c], n, max(margin, 0)):
            raise InputError(f"cell {c + 1} at {at[c].tolist()} does not fit in the cube of edge {edge}: its "
                             f"block leaves less than {margin} background elements to the cube's surface")
        if not _free(start[c], size[c], start[:c], size[:c]):
            raise InputError(f"the block around cell {c + 1} at {at[c].tolist()} overlaps another cell's; "
                             "move it away, or raise n so that blocks are closer to the cells")
    return Places(at, start, size)
