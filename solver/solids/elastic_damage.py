"""Elastic solids that lose stiffness as bonds break for good."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..kernels.push import add_scaled
from ..points import Points
from .base import Floats, Property, Solid, unwritten, wanted
from .registry import register
from .uncoupled import Uncoupled, distortional, distortional_energy


@dataclass(eq=False)
class _Damage:
    """sigma = (1 - D) sigma_0, D = Dmax cdf(largest value of the criterion so far).

    History: the largest value up to the present, D. Nims et al., J. R. Soc. Interface Focus 6 (2016) 20150063.
    """

    consistent = False
    elastic: Solid | None = None
    damage: Any = None
    criterion: Any = None
    properties = {
        "elastic": Property("solid"),
        "damage": Property("cdf"),
        "criterion": Property("criterion"),
    }
    history = 2

    def _damage(self, pts: Points) -> Floats:
        at = self.offset  # type: ignore[attr-defined]
        X = self.criterion.of(self.elastic, pts)
        if pts.old is not None:
            X = np.maximum(X, pts.old[:, at])
        D = np.ascontiguousarray(np.broadcast_to(self.damage.damage(pts, X), (pts.n,)))
        if pts.new is not None:
            pts.new[:, at] = np.maximum(X, 0.0)
            pts.new[:, at + 1] = D
        return D

    def broken(self, pts: Points) -> Floats | float:
        if pts.new is not None:
            return pts.new[:, self.offset + 1]  # type: ignore[attr-defined, index]
        return self._damage(self.inner(pts))  # type: ignore[attr-defined, no-any-return]

    def _weaken(
        self,
        pts: Points,
        s: Floats,
        c: Floats | None,
        law: Callable[[Points, Floats, Floats | None], None],
    ) -> None:
        within = self.inner(pts)  # type: ignore[attr-defined]
        D = self._damage(within)
        s0 = np.zeros((pts.n, 6))
        c0 = None if c is None else np.zeros((pts.n, 6, 6))
        law(within, s0, c0)
        add_scaled(1.0 - D, s0, wanted(c0), s, wanted(c))


@dataclass(eq=False)
class ElasticDamage(_Damage, Solid):
    """Damage of a compressible solid; the tangent is (1 - D) c_0, as where damage does not grow."""

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._weaken(pts, s, c, self.elastic.stress)  # type: ignore[union-attr]

    def energy(self, pts: Points) -> Floats:
        within = self.inner(unwritten(pts))
        return (1.0 - self._damage(within)) * self.elastic.energy(within)  # type: ignore[union-attr]


@dataclass(eq=False)
class UncoupledElasticDamage(_Damage, Uncoupled):
    """Damage of the distortional stress of a nearly incompressible solid."""

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._weaken(pts, s, c, distortional(self.elastic))  # type: ignore[arg-type]

    def dev_energy(self, pts: Points) -> Floats:
        within = self.inner(unwritten(pts))
        return (1.0 - self._damage(within)) * distortional_energy(self.elastic, within)  # type: ignore[arg-type, operator]


register(ElasticDamage, "elastic damage")
register(UncoupledElasticDamage, "uncoupled elastic damage")
