"""Bearing load: a pressure over the loaded half of a cylinder that adds up to a force."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..kernels.surface import areas, normal_force, normal_stiffness, normals
from . import register
from .base import Floats, Matrices, Number, Patch, SurfaceLoad, Vector, scalar, vector

NEARLY_ZERO = 1e-3  # of the quadric's largest eigenvalue


def cylinder_axis(points: Floats) -> Floats:
    """Axis of the cylinder through points (n, 3), by the best quadric x.C x + v.x + c = 0.

    Raises ValueError where the quadric is no cylinder.
    """
    p = points - points.mean(axis=0)
    p = p / np.abs(p).max()
    x, y, z = p.T
    columns = [x * x, y * y, z * z, y * z, x * z, x * y, x, y, z, np.ones_like(x)]
    q = np.linalg.svd(np.column_stack(columns), full_matrices=False)[2][-1]
    C = np.array([[q[0], q[5] / 2, q[4] / 2], [q[5] / 2, q[1], q[3] / 2], [q[4] / 2, q[3] / 2, q[2]]])
    values, vectors = np.linalg.eigh(C)
    order = np.argsort(np.abs(values))
    if abs(values[order[0]]) > NEARLY_ZERO * abs(values[order[2]]):
        raise ValueError("the surface of a bearing load must be part of a cylinder")
    axis = vectors[:, order[0]]
    return np.where(np.abs(axis) < NEARLY_ZERO, 0.0, axis)

if TYPE_CHECKING:
    from ..state import State


@dataclass(eq=False)
class Bearing(SurfaceLoad):
    """Pressure scale |force| c^k / sum(A c^(k+1)) on facets with c = cos(angle to the force) > 0.

    k = 1 for the sine profile (FEBio's number 0), 2 for the parabolic one (1). The part of the force
    along the axis is left out. Normals follow the motion unless ``linear``; areas are the reference's.
    FEBio User Manual, "Bearing Load".
    """

    force: Vector = (0.0, 0.0, 0.0)
    scale: Number = 1.0
    profile: int = 0
    linear: bool = False
    symmetric_stiffness: bool = True
    parameters = ("force", "scale")
    vectors = ("force",)
    _axis: Floats | None = field(default=None, init=False, repr=False)

    @property
    def symmetric(self) -> bool:
        return self.symmetric_stiffness or self.linear

    @property
    def tangent(self) -> bool:
        return not self.linear

    def _direction(self, state: State, force: Floats) -> Floats:
        """Direction of the force across the axis."""
        if self._axis is None:
            nodes = np.unique(np.concatenate([p.conn.ravel() for p in self.surface]))
            self._axis = cylinder_axis(self.positions(state, reference=True)[nodes])
        axis = self._axis
        across = force - axis * (axis @ force) / (axis @ axis)
        size = np.linalg.norm(across)
        return np.asarray(across / size if size > 0 else across)

    def _pressures(self, state: State) -> list[tuple[Patch, Floats]]:
        """Traction along the normal at the points of each patch."""
        X, x = self.positions(state, reference=True), self.positions(state, self.linear)
        force = vector(self.force, state.time, X[:1], np.zeros(1, np.int64))[0]
        k, direction, total = self.profile + 1, self._direction(state, force), 0.0
        cosines = []
        for p in self.surface:
            n, A = np.empty((len(p.conn), 3)), np.empty(len(p.conn))
            at_center = np.ascontiguousarray(p.element.gradient(p.element.center)[0])
            normals(x, p.conn, at_center, n)
            areas(X, p.conn, p.element.dN, p.element.weights, A)
            c = np.maximum(-n @ direction, 0.0)
            total += float(A @ c ** (k + 1))
            cosines.append(c)
        unit = float(np.linalg.norm(force)) / total if total > 0 else 0.0
        return [
            (p, -self.sign * unit * scalar(self.scale, state.time, p) * np.repeat(c**k, p.element.npoints))
            for p, c in zip(self.surface, cosines, strict=True)
        ]

    def residual(self, state: State, R: Floats) -> None:
        x = self.positions(state, self.linear)
        for p, P in self._pressures(state):
            f = np.zeros((*p.conn.shape, 3))
            normal_force(x, *p.geometry, P, f)
            self.add(state, p, f, R)

    def stiffness(self, state: State, groups: Any = None) -> Matrices:
        """The change of the pressure's profile is left out, as in FEBio."""
        if self.linear:
            return []
        x, out = self.positions(state), []
        for p, P in self._pressures(state):
            K, nodes, columns = self.matrices(state, p)
            normal_stiffness(x, *p.geometry, P, self.symmetric_stiffness, K)
            out.append((K, nodes, columns))
        return out


register(Bearing, "bearing load")
