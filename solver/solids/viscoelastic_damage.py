"""Viscoelastic solids that also lose stiffness as bonds fail."""

from __future__ import annotations

from dataclasses import field
from typing import Any

import numpy as np

from ..kernels.push import add_scaled
from ..points import Points
from ..record import variable_record
from .base import Floats, Property, Solid, unwritten, wanted
from .elastic_damage import ElasticDamage, UncoupledElasticDamage
from .reactive_viscoelastic import ReactiveViscoelastic
from .registry import register
from .uncoupled import Uncoupled, distortional
from .viscoelastic import _Series


@variable_record
class _DamagedSeries(_Series):
    """(1 - D) times the viscoelastic stress of the undamaged solid; ``elastic`` is an elastic damage solid."""

    consistent = False

    def _damaged(self, pts: Points, s: Floats, c: Floats | None) -> None:
        damage: Any = self.elastic
        within = self.inner(pts)  # type: ignore[attr-defined]
        D = damage._damage(within)
        s0 = np.zeros((pts.n, 6))
        c0 = None if c is None else np.zeros((pts.n, 6, 6))
        self._relax(pts, s0, c0, distortional(damage.elastic))
        add_scaled(1.0 - D, s0, wanted(c0), s, wanted(c))


@variable_record
class ViscoelasticDamage(_DamagedSeries, Solid):
    """A Prony series over a damaged compressible solid."""

    elastic: ElasticDamage | None = field(default=None)

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._damaged(pts, s, c)


@variable_record
class UncoupledViscoelasticDamage(_DamagedSeries, Uncoupled):
    """A Prony series over a damaged nearly incompressible solid."""

    elastic: UncoupledElasticDamage | None = field(default=None)

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._damaged(pts, s, c)


@variable_record
class ReactiveViscoelasticDamage(Solid):
    """(1 - D) times a reactive viscoelastic stress, D by a criterion of its strong bonds.

    History: the largest value of the criterion, D.
    """

    consistent = False
    viscoelastic: ReactiveViscoelastic | None = None
    damage: Any = None
    criterion: Any = None
    properties = {
        "viscoelastic": Property("solid"),
        "damage": Property("cdf"),
        "criterion": Property("criterion"),
    }
    history = 2

    def _damage(self, pts: Points) -> Floats:
        X = self.criterion.of(self.viscoelastic.elastic, pts)  # type: ignore[union-attr]
        if pts.old is not None:
            X = np.maximum(X, pts.old[:, self.offset])
        D = np.ascontiguousarray(np.broadcast_to(self.damage.damage(pts, X), (pts.n,)))
        if pts.new is not None:
            pts.new[:, self.offset], pts.new[:, self.offset + 1] = np.maximum(X, 0.0), D
        return D

    def broken(self, pts: Points) -> Floats | float:
        return 0.0 if pts.new is None else pts.new[:, self.offset + 1]

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        within = self.inner(pts)
        s0 = np.zeros((pts.n, 6))
        c0 = None if c is None else np.zeros((pts.n, 6, 6))
        self.viscoelastic.stress(within, s0, c0)  # type: ignore[union-attr]
        add_scaled(1.0 - self._damage(within), s0, wanted(c0), s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        within = self.inner(unwritten(pts))
        return (1.0 - self._damage(within)) * self.viscoelastic.energy(within)  # type: ignore[union-attr]


register(ViscoelasticDamage, "viscoelastic damage")
register(UncoupledViscoelasticDamage, "uncoupled viscoelastic damage")
register(ReactiveViscoelasticDamage, "reactive viscoelastic damage")
