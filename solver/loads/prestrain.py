"""Prestrains that are corrected, augmentation by augmentation, until a body keeps its shape under them.

Maas et al., J. Mech. Behav. Biomed. Mater. 61 (2016) 499; FEBio user manual, "Prestrain update rules".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..action import Action
from ..points import Points
from ..solids.fiber import directions
from .base import Floats

if TYPE_CHECKING:
    from ..group import Group
    from ..state import State


@dataclass(eq=False)
class PrestrainCorrection(Action):
    """Fc <- F Fc in solids that are strained in the reference (:mod:`..solids.prestrain`).

    Corrections are made block by block until the Frobenius norm of their change is below ``tolerance`` at all points,
    ``least`` times at least and ``most`` times at most (negative: any number).
    """

    laugon: bool = True
    tolerance: float = 0.0
    least: int = 0
    most: int = -1
    _groups: list[Group] = field(init=False, default_factory=list)

    @property
    def augments(self) -> bool:
        return self.laugon

    def begin(self, state: State, groups: list[Group]) -> None:
        self._groups = [g for g in groups if getattr(g.block.solid, "corrects", False)]

    def residual(self, state: State, R: Floats) -> None:
        """It acts through the solids' stress alone."""

    def corrected(self, solid: Any, pts: Points, Fc: Floats) -> Floats:
        """The next correction (n, 3, 3)."""
        return pts.F @ Fc

    def augment(self, done: int, state: State) -> bool:
        settled = [self._augment(g, done, state) for g in self._groups]
        return all(settled)

    def _augment(self, group: Group, done: int, state: State) -> bool:
        pts = group.points()
        solid: Any = group.block.solid
        pts.t, pts.dt = state.time, state.dt
        Fc = solid.correction(pts)
        new = self.corrected(solid, pts, Fc)
        change = np.sqrt(((new - Fc) ** 2).sum(axis=(1, 2))).max(initial=0.0)
        settled = not 0.0 < self.tolerance <= change and done >= self.least
        if settled or 0 <= self.most <= done:
            return True
        Fc[:] = new
        return False


@dataclass(eq=False)
class StretchCorrection(PrestrainCorrection):
    """Fc = Q diag(1/l, l^1/2, l^1/2) Q^T of the material's axes Q and the stretch l of the fiber under F.

    Without the roots where not ``isochoric``; 1 where the solid has no fiber. Fibers that are stretched by more than
    ``most_stretch`` (where it is not 0) keep the correction they have.
    """

    most_stretch: float = 0.0
    isochoric: bool = True

    def corrected(self, solid: Any, pts: Points, Fc: Floats) -> Floats:
        if "fiber" not in solid.elastic.properties:
            return np.broadcast_to(np.eye(3), Fc.shape)
        within = solid.elastic.inner(solid.inner(pts))
        n = np.broadcast_to(directions(solid.elastic.fiber, within), (pts.n, 3))
        l = np.linalg.norm(np.einsum("nij,nj->ni", pts.F, n), axis=1)
        U = np.zeros((pts.n, 3, 3))
        U[:, 0, 0], U[:, 1, 1] = 1.0 / l, np.sqrt(l) if self.isochoric else 1.0
        U[:, 2, 2] = U[:, 1, 1]
        if within.Q is not None:
            U = within.Q @ U @ np.swapaxes(within.Q, 1, 2)
        kept = (self.most_stretch != 0.0) & (l > self.most_stretch)
        return np.where(kept[:, None, None], Fc, U)
