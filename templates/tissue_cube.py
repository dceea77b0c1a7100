"""The tissue: a cube of elements whose middle one has an edge of its own."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.model import InputError
from febkit.model.mesh import Floats

from .elements import filled
from .lattice import spaced
from .parts import Parts


def tissue_cube(p: dict[str, Any]) -> Parts:
    """Build the cube from the template's parameters (see templates/tissue/template.toml)."""
    n = int(p["n"])
    edge, centre, grading, kind = float(p["edge"]), float(p["centre"]), float(p["grading"]), str(p["element"])
    side = tissue_planes(n, edge, centre, grading)
    height = tissue_planes(int(p["vertical"]) or n, edge, centre, grading)
    X, conn = filled((side, side, height), kind)
    return Parts(X, {str(p["part"]): (kind, conn)})


def tissue_planes(n: int, edge: float, centre: float, ratio: float = 1.0) -> Floats:
    """n + 1 planes across the cube, the middle two ``centre`` apart (0: all equally spaced).

    ``ratio`` is the outermost over the innermost thickness outside the middle element.
    """
    if centre == 0.0:
        return np.linspace(-edge / 2.0, edge / 2.0, n + 1)
    if n % 2 == 0 or n < 3:
        raise InputError(f"n = {n} elements have no element in the middle: use an odd n of 3 or more, "
                         "or set centre = 0 for equal elements")
    if centre >= edge:
        raise InputError(f"centre ({centre}) must be smaller than the edge of the tissue ({edge})")
    side = spaced(centre / 2.0, edge / 2.0, (n - 1) // 2, ratio)
    return np.concatenate([-side[::-1], side])
