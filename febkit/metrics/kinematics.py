"""Deformation of a group of like elements at their integration points."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import tensors

if TYPE_CHECKING:
    from febkit.solver.elements.base import Element

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class State:
    """Positions x (3, n, e); at points: F (3, 3, g, e), J = det F, dv (g, e) deformed volume of the point.

    ``G`` (3, 3, g, e) is dr/dx, natural by current coordinates, there where it was asked for.
    """

    x: Floats
    F: Floats
    J: Floats
    dv: Floats
    G: Floats | None = None

    @property
    def volume(self) -> Floats:
        """(e,) deformed volumes."""
        return np.asarray(self.dv.sum(axis=0))


@dataclass(slots=True, eq=False)
class Group:
    """Elements of one type and one material.

    ``rows`` (e,) into the dataset's element dimension; ``nodes`` (n, e) 0-based node indices;
    ``owner`` (e,) index of the cell each belongs to; ``material`` a part that has its material ("": unknown).
    """

    element: Element
    rows: Ints
    nodes: Ints
    owner: Ints
    material: str
    X: Floats  # (N, 3) reference coordinates of all nodes
    x0: Floats = field(init=False)  # (3, n, e) reference positions
    dN: Floats = field(init=False)  # (g*3, n)
    inv: Floats = field(init=False)  # (3, 3, g, e) dr/dX
    dV: Floats = field(init=False)  # (g, e) reference volume of the points

    def __post_init__(self) -> None:
        el = self.element
        self.dN = np.ascontiguousarray(el.dN.transpose(0, 2, 1).reshape(-1, el.nodes))
        self.x0 = self.positions(self.X)
        A = self._jacobian(self.x0)
        det = tensors.determinant(A)
        self.inv = tensors.inverse(A, det)
        self.dV = det * el.weights[:, None]

    def positions(self, nodal: Floats) -> Floats:
        """(3, n, e) of nodal vectors (N, 3)."""
        return np.ascontiguousarray(nodal[self.nodes].transpose(2, 0, 1))

    def _jacobian(self, x: Floats) -> Floats:
        """(3, 3, g, e) dx_i/dr_j."""
        g = self.element.npoints
        A = np.matmul(self.dN, x).reshape(3, g, 3, -1)
        return np.asarray(A.transpose(0, 2, 1, 3))

    def at(self, u: Floats, gradient: bool = False) -> State:
        """State for nodal displacements ``u`` (N, 3)."""
        x = self.x0 + self.positions(u)
        A = self._jacobian(x)
        F = tensors.multiply(A, self.inv)
        J = tensors.determinant(F)
        dv = J * self.dV
        G = tensors.inverse(A) if gradient else None
        return State(x, F, J, dv, G)

    def mean(self, values: Floats) -> Floats:
        """Plain mean over the integration points of (..., g, e): the element's value in the study."""
        return np.asarray(values.mean(axis=-2))

    def at_points(self, nodal: Floats) -> Floats:
        """(..., g, e) of element-node values (..., n, e)."""
        return np.asarray(np.matmul(self.element.N, nodal))

    def to_nodes(self, values: Floats) -> Floats:
        """(..., n, e) FEBio's extrapolation of integration-point values (..., g, e) to the nodes."""
        return np.asarray(np.matmul(self.element.extrapolation, values))
