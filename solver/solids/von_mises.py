"""Plasticity at small strains with isotropic hardening."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number, Solid
from .registry import register
from .voigt import matrix, vector

_ROOT = np.sqrt(2.0 / 3.0)
_ONE = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
_UNIT = np.diag([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
_DEVIATORIC = _UNIT - np.outer(_ONE, _ONE) / 3.0
_STRAIN, _STRESS, _Y = slice(0, 6), slice(6, 12), 12


@dataclass(eq=False)
class VonMisesPlasticity(Solid):
    """Radial return of the stress of linear elasticity (E, v) to |dev sigma| = (2/3)^1/2 Y; strain is sym F - 1.

    A step that yields by L = (|dev trial| - (2/3)^1/2 Y) / (2 G + H) raises Y by H L / (2/3)^1/2. The law is not
    objective, as FEBio's. History: strain, stress, growth of Y.
    """

    consistent = False
    E: Number = 0.0
    v: Number = 0.0
    Y: Number = 0.0
    H: Number = 0.0
    parameters = ("E", "v", "Y", "H")
    history = 13

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        E, v, Y, H = self.par(pts).T
        G, K = 0.5 * E / (1.0 + v), E / (3.0 * (1.0 - 2.0 * v))
        old = np.zeros((pts.n, 13)) if pts.old is None else pts.old[:, self.offset : self.offset + 13]
        e = vector(0.5 * (pts.F + np.swapaxes(pts.F, 1, 2)) - np.eye(3))
        de = e - old[:, _STRAIN]
        trial = old[:, _STRESS] + 2.0 * G[:, None] * de + np.outer((K - 2.0 / 3.0 * G) * de[:, :3].sum(axis=1), _ONE)
        mean = np.outer(trial[:, :3].sum(axis=1) / 3.0, _ONE)
        dev = trial - mean
        size = np.sqrt((matrix(dev) ** 2).sum((1, 2)))
        L = np.maximum(size - _ROOT * (Y + old[:, _Y]), 0.0) / (2.0 * G + H)
        some = np.where(size > 0, size, 1.0)
        left = 1.0 - 2.0 * G * L / some
        own = mean + left[:, None] * dev
        s += own
        if pts.new is not None:
            new = np.column_stack((e, own, old[:, _Y] + H * L / _ROOT))
            pts.new[:, self.offset : self.offset + 13] = new
        if c is not None:
            n = dev / some[:, None]
            flow = np.where(L > 0, 4.0 * G * G * (1.0 / (2.0 * G + H) - L / some), 0.0)
            c += np.multiply.outer(K + 0.0 * L, np.outer(_ONE, _ONE)) - flow[:, None, None] * n[:, :, None] * n[:, None]
            c += np.multiply.outer(2.0 * G * left, _DEVIATORIC)


register(VonMisesPlasticity, "von-Mises plasticity")
