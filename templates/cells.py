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
    """A cell in its pericellular matrix (PCM), both about the middle of the PCM.

    Lengths are the model's own (mm in the study).
    """

    cell: Superellipsoid
    pcm: Superellipsoid

    @property
    def volumes(self) -> tuple[float, float]:
        """Exact volumes of the cell and of its PCM."""
        return self.cell.volume, self.pcm.volume - self.cell.volume

    @property
    def thickness(self) -> tuple[float, float]:
        """Least and largest thickness of the PCM, along rays from the cell's centre."""
        return gap(self.cell, self.pcm)


def make_chondrons(p: Mapping[str, Any], count: int, rng: np.random.Generator) -> list[Chondron]:
    """Chondrons from a template's ``diameter, squareness, thickness, pcm_squareness, shift, orientation``.

    The PCM's surface is the superellipsoid of semi-axes a + thickness on the cell's axes (for a sphere in a PCM of
    one thickness: the parallel surface); ``shift`` moves the cell in it along these axes.
    """
    axes = per_cell("diameter", p["diameter"], count) / 2.0
    thick = per_cell("thickness", p["thickness"], count)
    square = per_cell("squareness", p["squareness"], count)
    outer = per_cell("pcm_squareness", p["pcm_squareness"], count)
    outer = np.where(outer == 0.0, square, outer)
    if (axes <= 0).any() or (thick <= 0).any():
        raise InputError("diameters and thicknesses must be positive")
    for name, n in (("squareness", square), ("pcm_squareness", outer)):
        if (n < 1).any() or (n > MOST_SQUARE).any():
            raise InputError(f"{name} must lie between 1 and {MOST_SQUARE} (2: an ellipsoid), not {n.ravel().tolist()}")
    along = isinstance(p["shift"], int | float)
    moved = per_cell("shift", [[0.0, 0.0, p["shift"]]] if along else p["shift"], count)
    rotation = rotations(count, p["orientation"], rng)
    made = []
    for c in range(count):
        R = rotation[c]
        cell = Superellipsoid(axes[c], square[c], R, R @ moved[c])
        made.append(Chondron(cell, Superellipsoid(axes[c] + thick[c], outer[c], R, np.zeros(3))))
        _check(made[-1], c + 1)
    return made


# beyond it, a superellipsoid is a box to all meshes: its edges' radius is 1 % of its size
MOST_SQUARE = 50.0


def _check(c: Chondron, number: int) -> None:
    """A cell lies inside its PCM: so it does where it is in the middle of one of its own form."""
    if not c.cell.centre.any() and np.array_equal(c.cell.squareness, c.pcm.squareness):
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
