"""What a rigid body is: its parts, its nodes, and its mass."""

from __future__ import annotations

from dataclasses import field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .. import elements
from ..matrices import det
from ..physics.base import Physics, Work
from ..points import Points
from ..problem import Block
from ..record import variable_record

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Weight(Work):
    """What is asked of a part's work: its mass, at each turn, and it stays."""

    def mass(self) -> tuple[Floats, Floats | None]:
        return self._mass

    @cached_property
    def _mass(self) -> tuple[Floats, Floats | None]:
        return super().mass()


class Part:
    """Elements of a rigid body: what body loads need of a group (:mod:`..loads.body`).

    ``thickness`` (element, node): the elements are facets, of shells.
    """

    def __init__(self, block: Block, X: Floats, thickness: Floats | None = None) -> None:
        self.block = block
        self.conn = np.ascontiguousarray(block.conn, dtype=np.int32)
        e = elements.get(block.element, block.rule)
        self.N, x = np.ascontiguousarray(e.N), X[self.conn]
        self.m, self.n, self.g = *self.conn.shape, len(e.weights)
        J = np.einsum("gaj,eai->egij", e.dN, x)
        if thickness is None:
            volume = det(J)
        else:
            volume = np.linalg.norm(np.cross(J[..., 0], J[..., 1]), axis=-1) * (thickness @ e.N.T)
        self.wJ0 = volume * e.weights
        self.Xg = np.einsum("ga,eai->egi", self.N, x).reshape(-1, 3)
        self.physics = Weight(self, Physics())  # type: ignore[arg-type]

    def points(self) -> Points:
        n = self.m * self.g
        return Points(np.tile(np.eye(3), (n, 1, 1)), np.ones(n), self.Xg, np.repeat(np.arange(self.m), self.g))

    @property
    def mass(self) -> Floats:
        """Mass of the integration points (m g,)."""
        return np.asarray(self.wJ0.reshape(-1) * self.block.solid.density(self.points()))


@variable_record
class RigidBody:
    """``centre`` (3,) of mass, given or that of the parts; ``inertia`` (3, 3) about it; all of the reference.

    ``nodes`` are those of its parts; others are attached step by step (:class:`..problem.Attached`).
    """

    name: str
    parts: list[Part] = field(default_factory=list)
    given: Floats | None = None
    extra: list[Ints] = field(default_factory=list)
    mass: float = field(init=False)
    centre: Floats = field(init=False)
    inertia: Floats = field(init=False)

    def __post_init__(self) -> None:
        m = np.concatenate([np.zeros(0), *(p.mass for p in self.parts)])
        X = np.concatenate([np.zeros((0, 3)), *(p.Xg for p in self.parts)])
        self.mass = float(m.sum())
        self.centre = np.zeros(3)
        if self.given is not None:
            self.centre = np.asarray(self.given, float)
        elif self.mass:
            self.centre = m @ X / self.mass
        # the parallel axis theorem with the centre given, as FEBio has it
        about = np.einsum("q,qi,qi->", m, X, X) * np.eye(3) - np.einsum("q,qi,qj->ij", m, X, X)
        c = self.centre
        self.inertia = about - self.mass * (c @ c * np.eye(3) - np.outer(c, c))

    @property
    def nodes(self) -> Ints:
        return np.unique(np.concatenate([np.zeros(0, np.int64), *(p.conn.ravel() for p in self.parts), *self.extra]))
