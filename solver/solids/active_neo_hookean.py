"""Neo-Hookean solids with active tension in many directions; the tangent is the matrix's, as in FEBio."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..points import Points
from .base import Floats, Number
from .ellipsoidal_fibers import _dome
from .neo_hookean import NeoHookean
from .registry import register
from .voigt import vector


@dataclass(eq=False)
class _Active(NeoHookean):
    """sigma + sum_j ac |a N_j| n_j dyad n_j: ``a`` scales the components of the local directions N_j."""

    consistent = False
    a: Any = (0.0, 0.0, 0.0)
    active_contraction: Number = 0.0
    parameters = (*NeoHookean.parameters, "a", "active_contraction")
    vectors: ClassVar[dict[str, int]] = {"a": 3}

    def _local(self) -> Floats:
        """Directions (m, 3)."""
        raise NotImplementedError

    def _spatial(self, n: Floats) -> Floats:
        """n (n, m, 3) as they count."""
        return n

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        super().stress(pts, s, c)
        N, axes = self._local(), self.vector("a", pts)[:, None, :]
        Q = self.inner(pts).Q
        A = N[None] if Q is None else N[None] @ np.swapaxes(Q, 1, 2)
        n = self._spatial(A @ np.swapaxes(pts.F, 1, 2))
        size = self.par(pts)[:, -1:] * np.sqrt(((N[None, :, : axes.shape[2]] * axes) ** 2).sum(2))
        s += vector(np.einsum("nj,nji,njk->nik", np.broadcast_to(size, n.shape[:2]), n, n))


@dataclass(eq=False)
class PlanarActiveNeoHookean(_Active):
    """Twelve directions of the plane of the first two material axes; their mean, n_j = F N_j / |F N_j|."""

    a: Any = (0.0, 0.0)
    vectors = {"a": 2}

    def _local(self) -> Floats:
        t = 2.0 * np.pi * np.arange(12) / 12
        return np.stack((np.cos(t), np.sin(t), 0.0 * t), axis=1)

    def _spatial(self, n: Floats) -> Floats:
        return n / (np.linalg.norm(n, axis=2, keepdims=True) * np.sqrt(n.shape[1]))


@dataclass(eq=False)
class SphericalActiveNeoHookean(_Active):
    """The directions of a geodesic dome, n_j = F N_j; FEBio sums them without weights."""

    def _local(self) -> Floats:
        return _dome()[0]


register(PlanarActiveNeoHookean, "2D fiber neo-Hookean")
register(SphericalActiveNeoHookean, "fiber neo-Hookean")
