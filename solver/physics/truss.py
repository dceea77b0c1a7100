"""Trusses: straight lines that stretch. The force is A0 tau / lambda along the line, tau the Kirchhoff stress at the
stretch lambda and A0 the area in the reference. FEBio Theory Manual, "Truss elements"."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..fields import DISPLACEMENT, Field
from ..points import VOIGT, Points
from ..values import as_value
from . import register
from .base import Floats, Physics, Work

if TYPE_CHECKING:
    from ..group import Chunk, Group
    from ..lines import Lines
    from ..solids.base import Number
    from ..state import State
    from ..tangent import Target, Workspace


class TrussWork(Work):
    """stretch (m,), e (m, 3) direction, force (m,) and its derivative by the stretch, s (m, g, 6) stress."""

    memory: ClassVar[tuple[str, ...]] = ("stretch", "e", "force", "stiff", "s")
    held: ClassVar[Mapping[str, str]] = {"force": "force"}
    group: Lines

    def __init__(self, group: Group, physics: Any) -> None:
        super().__init__(group, physics)
        m = group.m
        self.law = physics
        self.stretch, self.e = np.ones(m), self.group.axis.copy()
        self.force, self.stiff = np.zeros(m), np.zeros(m)
        self.s = np.zeros((m, group.g, 6))

    def update(self, c: Chunk, state: State, drive: list[Any]) -> None:
        """At the displacements within the step that the other elements have theirs at."""
        g, e = self.group, slice(c.lo, c.hi)
        ends = g.conn[e, :2]
        x = (state.X + g.u)[ends]
        d = x[:, 1] - x[:, 0]
        l = np.sqrt((d * d).sum(axis=1))
        self.stretch[e] = l / g.length[e]
        self.e[e] = d / np.where(l > 0.0, l, 1.0)[:, None]
        self.act(e, state)

    def act(self, e: slice, state: State) -> None:
        """Forces, their derivatives and stresses of elements ``e`` at the present stretches."""
        raise NotImplementedError

    def residual(self, lo: int, hi: int, state: State, R: Floats, steady: bool) -> None:
        e, Ru = slice(lo, hi), state.layout.u(R)
        f = self.force[e, None] * self.e[e]
        np.add.at(Ru, self.group.conn[e, 0], f)
        np.add.at(Ru, self.group.conn[e, 1], -f)

    def tangent(self, c: Chunk, state: State, target: Target, work: Workspace, steady: bool) -> None:
        """dF/dl e e + F / l (1 - e e)."""
        g, e = self.group, slice(c.lo, c.hi)
        along = np.einsum("ei,ej->eij", self.e[e], self.e[e])
        l = (self.stretch[e] * g.length[e])[:, None, None]
        k = (self.stiff[e] / g.length[e])[:, None, None] * along
        k += self.force[e, None, None] / l * (np.eye(3) - along)
        K = k[:, :, None, :, None] * np.array([[1.0, -1.0], [-1.0, 1.0]])[None, None, :, None, :]
        target.add(g, c.lo, c.hi, np.ascontiguousarray(K.reshape(len(K), 6, 6)))

    outputs = {"stress": lambda w: w.s, "truss stretch": lambda w: np.repeat(w.stretch[:, None], w.group.g, axis=1)}


@dataclass(eq=False)
class Truss(Physics):
    """``area`` of the cross-section in the reference."""

    area: float = 0.0

    @property
    def fields(self) -> tuple[Field, ...]:
        return (DISPLACEMENT,)


class LinearWork(TrussWork):
    """tau = E ln lambda; stress tau / J along the line, J = lambda^(1 - 2 v)."""

    def act(self, e: slice, state: State) -> None:
        p, X = self.law, np.zeros((1, 3))
        E, v = (float(as_value(n)(state.time, X)[0]) for n in (p.E, p.v))
        lam = self.stretch[e]
        tau = E * np.log(lam)
        self.force[e] = p.area * tau / lam
        self.stiff[e] = p.area * (E - tau) / lam**2
        s = tau / lam ** (1.0 - 2.0 * v)
        self.s[e] = np.stack([s * self.e[e, i] * self.e[e, j] for i, j in VOIGT], axis=-1)[:, None]


@dataclass(eq=False)
class LinearTruss(Truss):
    """FEBio User Manual, "Linear truss"."""

    E: Number = 0.0
    v: Number = 0.5
    name: ClassVar[str] = "linear truss"
    work: ClassVar[type[Work]] = LinearWork


class ElasticWork(TrussWork):
    """The solid under F = diag(lambda, lambda^-v, lambda^-v) in axes of the truss, x along it; stresses in these axes.

    Uncoupled solids: the deviatoric stress and the pressure that leaves the sides free.
    """

    def act(self, e: slice, state: State) -> None:
        """dT/d lambda = J c : D + 2 D T, T = J s, D = diag(1, -v, -v) / lambda the rate of deformation."""
        v, lam, solid = self.law.v, self.stretch[e], self.group.block.solid
        pts = self._points(e, state)
        s, C = np.zeros((len(lam), 6)), np.zeros((len(lam), 6, 6))
        solid.stress(pts, s, C)
        D = np.array([1.0, -v, -v]) / lam[:, None]
        J = pts.J[:, None]
        T = J * s[:, :3]
        dT = J * np.einsum("eij,ej->ei", C[:, :3, :3], D) + 2.0 * D * T
        if solid.uncoupled:
            s[:, :3] -= s[:, 1, None]
            T, dT = T - T[:, 1, None], dT - dT[:, 1, None]
        self.s[e] = s[:, None]
        self.force[e] = self.law.area * T[:, 0] / lam
        self.stiff[e] = self.law.area * (dT[:, 0] - T[:, 0] / lam) / lam

    def _points(self, e: slice, state: State) -> Points:
        """A point of each element under its stretch."""
        g, lam = self.group, self.stretch[e]
        F = np.zeros((len(lam), 3, 3))
        F[:, 0, 0] = lam
        F[:, 1, 1] = F[:, 2, 2] = lam**-self.law.v
        J = lam ** (1.0 - 2.0 * self.law.v)
        return Points(F, J, g.Xg.reshape(g.m, g.g, 3)[e, 0], np.arange(g.m)[e], state.time, state.dt)


@dataclass(eq=False)
class ElasticTruss(Truss):
    """A truss of any solid. FEBio User Manual, "elastic-truss"."""

    v: float = 0.5
    name: ClassVar[str] = "elastic truss"
    work: ClassVar[type[Work]] = ElasticWork


register(LinearTruss, "linear truss")
register(ElasticTruss, "elastic truss")
