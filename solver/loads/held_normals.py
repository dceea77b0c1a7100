"""Nodes of a surface that may not move along its normals.

FEBio user manual, "Symmetry plane" and "Fixed normal displacement".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .base import Floats, Ints
from .springs import ConstraintSet

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class HeldNormals(ConstraintSet):
    """n . u = 0 at each of ``nodes`` (m, 3), one node thrice a row, by penalty or augmented Lagrangian.

    n is the unit normal that the ``facets`` (f, n) have at the nodes ``at`` (m,) as the constraint begins to act.
    """

    facets: tuple[Ints, ...] = ()
    at: Ints = ()  # type: ignore[assignment]

    @classmethod
    def of(cls, facets: tuple[Ints, ...], at: Ints, nodes: Ints, columns: Ints, **options: Any) -> HeldNormals:
        """Of ``nodes`` (m,) along the normals at ``at`` (m,); ``columns`` (3,) are those of the displacement."""
        shape = (len(nodes), 3)
        rows, own = np.repeat(nodes[:, None], 3, axis=1), np.broadcast_to(columns, shape).copy()
        return cls(rows, own, np.zeros(shape), facets=facets, at=at, **options)

    def begin(self, state: State, groups: Any) -> None:
        super().begin(state, groups)
        super().begin(state, groups)
        self.coefficients = normals(state.x, self.facets)[self.at]


def normals(x: Floats, facets: tuple[Ints, ...]) -> Floats:
    """Unit normals (node, 3), zero off the surface: sums over facets of e_next x e_previous, edges to the nodes beside.

    Beside in the facet's numbering, also where nodes on edges follow the corners (as FEBio has it).
    """
    out = np.zeros_like(x)
    for f in facets:
        ahead, back = (x[np.roll(f, k, axis=1)] - x[f] for k in (-1, 1))
        np.add.at(out, f, np.cross(ahead, back))
    size = np.linalg.norm(out, axis=1)
    return np.asarray(out / np.where(size > 0.0, size, 1.0)[:, None])
