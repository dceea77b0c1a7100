"""Solids whose second Piola-Kirchhoff stress is a function of the strain in local axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..kernels.material_frame import add_projected, push_frame, strain_in_frame
from ..matrices import inv
from ..points import Points
from .base import NO_TANGENT, Floats, Number, Solid, wanted

_GLOBAL = np.eye(3)[None]
_TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


def stiffness(l: Floats, mu: Floats) -> Floats:
    """D (k, 6, 6) of W = sum mu_i a_i . E^2 a_i + 1/2 sum lambda_ij E_ii E_jj; ``l`` (k, 3, 3), ``mu`` (k, 3)."""
    D = np.zeros((len(l), 6, 6))
    D[:, :3, :3] = l
    for i in range(3):
        D[:, i, i] += 2.0 * mu[:, i]
    for a, (i, j) in enumerate(((0, 1), (1, 2), (0, 2))):
        D[:, a + 3, a + 3] = 0.5 * (mu[:, i] + mu[:, j])
    return D


@dataclass(eq=False)
class Engineering:
    """Young's moduli, shear moduli and Poisson's ratios of an orthotropic solid."""

    E1: Number = 0.0
    E2: Number = 0.0
    E3: Number = 0.0
    G12: Number = 0.0
    G23: Number = 0.0
    G31: Number = 0.0
    v12: Number = 0.0
    v23: Number = 0.0
    v31: Number = 0.0
    parameters: ClassVar[tuple[str, ...]] = ("E1", "E2", "E3", "G12", "G23", "G31", "v12", "v23", "v31")

    def stiffness(self, par: Floats) -> Floats:
        """D (k, 6, 6) in local axes, from the inverse of the compliance."""
        E1, E2, E3, G12, G23, G31, v12, v23, v31 = par.T[:9]
        C = np.empty((len(par), 3, 3))
        C[:, 0, 0], C[:, 1, 1], C[:, 2, 2] = 1 / E1, 1 / E2, 1 / E3
        C[:, 0, 1] = C[:, 1, 0] = -v12 / E1
        C[:, 1, 2] = C[:, 2, 1] = -v23 / E2
        C[:, 2, 0] = C[:, 0, 2] = -v31 / E3
        mu = np.stack((G12 + G31 - G23, G12 - G31 + G23, G31 + G23 - G12), axis=1)
        l: Floats = inv(C).astype(float, copy=False)
        l[:, [0, 1, 2], [0, 1, 2]] -= 2.0 * mu
        return stiffness(l, mu)


@dataclass(eq=False)
class LocalStrain(Solid):
    """Subclasses give ``law(pts, E, D, W)`` of the local strain; ``iso`` for a distortional law."""

    iso = False

    def law(self, pts: Points, E: Floats) -> tuple[Floats, Floats, Floats]:
        """S (n, 6), dS/dE (n, 6, 6) and W (n,) of the local strain (n, 6; shear not doubled)."""
        raise NotImplementedError

    def _frame(self, pts: Points) -> Floats:
        Q = self.inner(pts).Q
        return _GLOBAL if Q is None else Q

    def _strain(self, pts: Points) -> Floats:
        E = np.empty((pts.n, 6))
        strain_in_frame(pts.F, self._frame(pts), self.iso, pts.J, E)
        return E

    def _add(self, pts: Points, s: Floats, c: Floats | None) -> None:
        S, D, _ = self.law(pts, self._strain(pts))
        T = np.empty((pts.n, 6))
        h = NO_TANGENT if c is None else np.empty((pts.n, 6, 6))
        push_frame(pts.F, self._frame(pts), self.iso, pts.J, S, np.ascontiguousarray(D), T, h)
        add_projected(pts.J, T, h, self.iso, s, wanted(c))

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c)

    def energy(self, pts: Points) -> Floats:
        return self.law(pts, self._strain(pts))[2]


def linear(E: Floats, D: Floats) -> tuple[Floats, Floats]:
    """S = D : E and W = E : D : E / 2."""
    S = np.einsum("nij,nj->ni", np.broadcast_to(D, (len(E), 6, 6)), E * _TWICE)
    return S, 0.5 * (S * E * _TWICE).sum(1)
