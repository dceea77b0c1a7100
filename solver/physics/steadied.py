"""A fluid pressure steadied by projection (:mod:`..kernels.projection`), whatever else the fluid carries."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..kernels import projection

if TYPE_CHECKING:
    from ..group import Group

Floats = NDArray[np.float64]
_NONE = np.zeros((0, 0))


class Steadied:
    """``coefficient`` (m,) of the projection, None until :meth:`begin`; ``old`` (m, g): pressures at the last
    converged state."""

    def __init__(self, group: Group) -> None:
        self.group = group
        self.coefficient: Floats | None = None
        self.old = _NONE

    def begin(self, tau: float) -> None:
        """c = tau max(1 / (2 G), 3 / H) from the solid's moduli at rest."""
        g = self.group
        pts = g.at_rest()
        s, C = np.zeros((pts.n, 6)), np.zeros((pts.n, 6, 6))
        g.block.solid.stress(pts, s, C)
        diagonal = C[:, range(6), range(6)].reshape(g.m, g.g, 6).mean(axis=1)
        shear, aggregate = diagonal[:, 3:].mean(axis=1), diagonal[:, :3].mean(axis=1)
        self.old = np.zeros((g.m, g.g))
        self.coefficient = tau * np.maximum(0.5 / shear, 3.0 / aggregate)

    def begin_step(self, p: Floats) -> None:
        """The pressures p (m, g) become those of the last converged state."""
        if self.coefficient is not None:
            self.old = p.copy()

    def rates(self, p: Floats) -> list[tuple[Floats, Floats]]:
        """What rates are differences of."""
        return [] if self.coefficient is None else [(self.old, p)]

    def force(self, lo: int, hi: int, p: Floats, R: Floats) -> None:
        """Subtract the forces of elements lo:hi from the pressure's rows R (node,)."""
        if self.coefficient is not None:
            g = self.group
            projection.force(lo, hi, g.conn, g.N, g.wJ0, self.coefficient, p, self.old, R)

    def tangent(self, lo: int, hi: int, K: Floats, at: int, to: int) -> None:
        """Add the tangents of elements lo:hi to K, whose block of the pressure begins at row ``at``, column ``to``."""
        if self.coefficient is not None:
            projection.tangent(lo, hi, self.group.N, self.group.wJ0, self.coefficient, K, at, to)
