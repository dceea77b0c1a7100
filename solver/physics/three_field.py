"""Uncoupled solids in displacements, with a pressure and a dilatation that are constant over each element.

Simo, Taylor and Pister, Comput Methods Appl Mech Engrg 51 (1985); augmented as in FEBio's theory manual.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..kernels import three_field
from ..points import Points
from ..record import variable_record
from . import register
from .base import Floats, Work
from .standard import Standard, StandardWork

if TYPE_CHECKING:
    from ..group import Chunk, Group
    from ..state import State

PRESSURE = 1.0 - 2.0 * np.eye(3)  # 1 x 1 - 2 I among normal components: the tangent of a pressure, per pressure


@variable_record
class Augment:
    """Augmented Lagrangian of the element pressures: relative tolerance, least and most augmentations."""

    tolerance: float = 0.01
    least: int = 0
    most: int = 0


class ThreeFieldWork(StandardWork):
    """eJ (m,) mean relative volume, ep (m,) pressure and Lk (m,) multiplier of each element."""

    memory: ClassVar[tuple[str, ...]] = ("s", "eJ", "ep", "Lk")

    def __init__(self, group: Group, physics: ThreeField) -> None:
        super().__init__(group, physics)
        self.law: Any = group.block.solid
        self.options = physics.augment
        self.eJ, self.ep, self.Lk = np.ones(group.m), np.zeros(group.m), np.zeros(group.m)
        self.volume = group.wJ0.sum(axis=1)  # of the reference (m,)

    @property
    def augments(self) -> bool:
        return self.options is not None

    def stress(self, c: Chunk, s: Floats) -> None:
        g, e = self.group, slice(c.lo, c.hi)
        self.eJ[e] = (g.wJ0[e] * g.J[e]).sum(axis=1) / self.volume[e]
        self.law.dev(c.points, s, None)
        p = self._of_mean(self.law.pressure, c)
        # the multiplier acts through h(J) = ln J, h' = 1/J (FEBio's augmented Lagrangian)
        self.ep[e] = p + self.Lk[e] / self.eJ[e]
        s[:, :3] += self.ep[e].repeat(g.g)[:, None]

    def _of_mean(self, law: Callable[[Floats, Points], Floats], c: Chunk) -> Floats:
        """A volumetric law at the element-mean relative volumes of a chunk."""
        return law(self.eJ[c.lo : c.hi].repeat(self.group.g), c.points)[:: self.group.g]

    def moduli(self, c: Chunk, s: Floats, C: Floats) -> None:
        """Deviatoric law and the element pressure's share of stress and tangent."""
        self.law.dev(c.points, s, C)
        p = np.repeat(self.ep[c.lo : c.hi], self.group.g)
        s[:, :3] += p[:, None]
        C[:, :3, :3] += p[:, None, None] * PRESSURE
        C[:, [3, 4, 5], [3, 4, 5]] -= p[:, None]

    def bulk(self, c: Chunk) -> Floats:
        """Bulk modulus (element,) with the multiplier's share."""
        e = slice(c.lo, c.hi)
        k = self._of_mean(self.law.bulk, c) - self.Lk[e] / self.eJ[e] ** 2
        return k / self.group.alphaf

    def dilate(self, lo: int, hi: int, bulk: Floats, K: Floats) -> None:
        three_field.dilatation(lo, hi, *self.group.geometry, bulk, K)

    def end(self, state: State, alphaf: float) -> None:
        if self.group.shell:
            self._end_pressure(state.u)
        super().end(state, alphaf)

    def _end_pressure(self, u: Floats) -> None:
        """Shells: the pressure goes by the mean relative volume at the step's end (FEBio 4.11)."""
        g = self.group
        F, J = np.empty_like(g.F), np.empty_like(g.J)
        g.deform(u, F, J)
        self.eJ[:] = (g.wJ0 * J).sum(axis=1) / self.volume
        before = self.ep.copy()
        self.ep[:] = self.law.pressure(np.repeat(self.eJ, g.g), g.points())[:: g.g] + self.Lk / self.eJ
        self.s[..., :3] += (self.ep - before)[:, None, None]

    def augment(self, done: int) -> bool:
        """One augmentation of the element pressures, lambda += k ln J with k the bulk modulus."""
        a, g = self.options, self.group
        if a is None:
            return True
        k = self.law.k(0.0, g.Xg[:: g.g], np.arange(g.m))
        new = self.Lk + k * np.log(self.eJ)
        n0, n1 = float(np.linalg.norm(self.Lk)), float(np.linalg.norm(new))
        change = abs((n1 - n0) / n1) if n1 > 1e-10 else 0.0
        converged = change < a.tolerance and done >= a.least
        converged = converged or (a.most > 0 and a.most <= done)
        if not converged:
            self.Lk[:] = new
        return converged


@variable_record
class ThreeField(Standard):
    """Element-mean dilatation; ``augment``: multipliers hold it at 1, where given."""

    augment: Augment | None = None
    name: ClassVar[str] = "three-field"
    work: ClassVar[type[Work]] = ThreeFieldWork


register(ThreeField, "three-field")
