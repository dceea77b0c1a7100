"""Chondrocytes in their pericellular matrix: sizes, squareness, orientations, eccentricity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from febkit.model import InputError
from febkit.model.mesh import Floats

from .superellipsoids import Superellipsoid, gap


@dataclass(frozen=True, slots=True, eq=False)
class Chondron:
    """A cell, or a row of them along axis ``column``, in a pericellular matrix (PCM); all about the PCM's middle.

    Lengths are the model's own (mm in the study).
    """

    cells: tuple[Superellipsoid, ...]
    pcm: Superellipsoid
    column: int = 2

    @property
    def cell(self) -> Superellipsoid:
        return self.cells[0]

    @property
    def volumes(self) -> tuple[float, float]:
        """Exact volumes of the cells and of their PCM."""
        inner = sum(c.volume for c in self.cells)
        return inner, self.pcm.volume - inner

    @property
    def thickness(self) -> tuple[float, float]:
        """Least and largest thickness of the PCM, along rays from the cells' centres, in a row away from its middle."""
        if len(self.cells) == 1:
            return gap(self.cell, self.pcm, np.zeros(3))
        found = [gap(c, self.pcm, c.centre) for c in (self.cells[0], self.cells[-1])]
        return min(t for t, _ in found), max(t for _, t in found)


def make_chondrons(p: Mapping[str, Any], count: int, rng: np.random.Generator) -> list[Chondron]:
    """Chondrons from a template's ``diameter, squareness, thickness, pcm_squareness, shift, orientation``.

    The PCM's surface is the superellipsoid of semi-axes a + thickness on the cell's axes (for a sphere in a PCM of
    one thickness: the parallel surface); ``shift`` moves the cell in it along these axes.
    """
    axes = per_cell("diameter", p["diameter"], count) / 2.0
    thick = per_cell("thickness", p["thickness"], count)
    square = per_cell("squareness", p["squareness"], count)
    given = per_cell("pcm_squareness", p["pcm_squareness"], count)
    outer = np.where(given == 0.0, square, given)
    if (axes <= 0).any() or (thick <= 0).any():
        raise InputError("diameters and thicknesses must be positive")
    for name, n in (("squareness", square), ("pcm_squareness", outer)):
        if (n < 1).any() or (n > MOST_SQUARE).any():
            raise InputError(f"{name} must lie between 1 and {MOST_SQUARE} (2: an ellipsoid), not {n.ravel().tolist()}")
    along = isinstance(p["shift"], int | float)
    moved = per_cell("shift", [[0.0, 0.0, p["shift"]]] if along else p["shift"], count)
    rotation = rotations(count, p["orientation"], rng)
    several, column = _groups(p, count)
    made = []
    for c in range(count):
        R = rotation[c]
        if several[c] > 1:
            _check_group(R, moved[c], c + 1)
            made.append(_group(several[c], column[c], axes[c], thick[c], square[c], given[c], float(p["spacing"])))
        else:
            cell = Superellipsoid(axes[c], square[c], R, R @ moved[c])
            made.append(Chondron((cell,), Superellipsoid(axes[c] + thick[c], outer[c], R, np.zeros(3))))
        _check(made[-1], c + 1)
    return made


def drawn_groups(density: float, volume: float, shares: list[float], seed: int) -> list[int]:
    """Cells of each chondron in a volume: as many cells as the density says, their chondrons drawn by ``shares``.

    ``shares[k]`` is the share of chondrons with k + 1 cells.
    """
    total = max(1, round(density * volume))
    if not shares or min(shares) < 0 or sum(shares) <= 0:
        raise InputError(f"shares must be those of chondrons with 1, 2, ... cells, such as [0.5, 0.5], not {shares}")
    rng = np.random.default_rng([seed, 1])  # of its own: positions stay those of the seed
    several: list[int] = []
    while sum(several) < total:
        drawn = int(rng.choice(len(shares), p=np.array(shares) / sum(shares))) + 1
        several.append(min(drawn, total - sum(several)))
    return several


def _groups(p: Mapping[str, Any], count: int) -> tuple[list[int], list[int]]:
    """Cells of each chondron, and the axis of its row."""
    several = p["group"] if isinstance(p["group"], list) else [p["group"]] * count
    column = p["column"] if isinstance(p["column"], list) else [p["column"]] * count
    if p["column"] == "random":
        column = np.random.default_rng([int(p["seed"]), 2]).choice(["x", "y", "z"], count).tolist()
    if len(several) != count or any(not isinstance(n, int) or n < 1 for n in several):
        raise InputError(f"group must be one whole number from 1, or {count} (one for each chondron), not {p['group']}")
    if len(column) != count or any(a not in ("x", "y", "z") for a in column):
        raise InputError(f"column must be x, y, z or random, or {count} axes (one a chondron), not {p['column']}")
    return several, ["xyz".index(a) for a in column]


def _check_group(R: Floats, shift: Floats, number: int) -> None:
    if shift.any() or not np.array_equal(R, np.eye(3)):
        raise InputError(f"chondron {number} has several cells: they lie along x, y or z about its middle; leave shift "
                         '0 and orientation "aligned", and say which with column')


def _group(several: int, column: int, axes: Floats, thick: Floats, square: Floats, outer: Floats,
           spacing: float) -> Chondron:
    """A row of equal cells ``spacing`` apart. Its PCM reaches ``thick`` beyond the row, squarer where not said."""
    along = np.eye(3)[column]
    step = 2.0 * axes[column] + spacing
    cells = tuple(Superellipsoid(axes, square, np.eye(3), along * (i - (several - 1) / 2.0) * step)
                  for i in range(several))
    around = np.where(outer == 0.0, np.maximum(square, GROUP_SQUARE), outer)
    return Chondron(cells, Superellipsoid(axes + thick + along * (several - 1) / 2.0 * step, around, np.eye(3),
                                          np.zeros(3)), column)


# beyond it, a superellipsoid is a box to all meshes: its edges' radius is 1 % of its size
MOST_SQUARE = 50.0
# least squareness of the PCM around a row of cells, which an ellipsoid would leave at its ends
GROUP_SQUARE = 3.0


def _check(c: Chondron, number: int) -> None:
    """A cell lies inside its PCM: so it does where it is in the middle of one of its own form."""
    if len(c.cells) == 1 and not c.cell.centre.any() and np.array_equal(c.cell.squareness, c.pcm.squareness):
        return
    least, _ = c.thickness
    if least <= 1e-3 * float(c.cell.semi_axes.min()):
        raise InputError(f"the PCM of cell {number} does not enclose it: its thickness goes down to {least:.4g} along "
                         "rays from the cell's centre; reduce shift, raise thickness, or make squareness and "
                         "pcm_squareness more alike")


def per_cell(name: str, value: Any, count: int) -> Floats:
    """(cell, 3) from a number, one for each cell, [x, y, z] for each cell, or [[x, y, z]] for all."""
    try:
        v = np.asarray(value, dtype=float)
    except ValueError:
        v = np.empty((0, 0))
    if v.shape in ((), (1,)):
        return np.full((count, 3), float(v.reshape(-1)[0]))
    if v.shape == (count,):
        return np.repeat(v[:, None], 3, axis=1)
    if v.shape in ((count, 3), (1, 3)) or (count == 1 and v.shape == (3,)):
        return np.broadcast_to(v, (count, 3)).copy()
    raise InputError(f"{name} must be one number, {count} numbers or {count} triples (one entry for each cell), or one "
                     f"triple in double brackets for all, not {value}")


def rotations(count: int, orientation: Any, rng: np.random.Generator) -> Floats:
    """Rotation matrices: "aligned" with the axes, "random", or given as rotation vectors (radians)."""
    if isinstance(orientation, str):
        if orientation == "aligned":
            return np.tile(np.eye(3), (count, 1, 1))
        if orientation == "about z":
            return rotations(count, np.outer(rng.uniform(0.0, np.pi, count), [0.0, 0.0, 1.0]), rng)
        if orientation == "random":
            q, r = np.linalg.qr(rng.standard_normal((count, 3, 3)))
            q = q * np.sign(np.einsum("cii->ci", r))[:, None, :]
            q[np.linalg.det(q) < 0, :, 0] *= -1.0
            return np.asarray(q)
        raise InputError(f'orientation must be "aligned", "random", "about z" or rotation vectors, not "{orientation}"')
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
