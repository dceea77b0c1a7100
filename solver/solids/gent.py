"""Gent solids: neo-Hookean with a limit of extensibility."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..points import Points
from .base import Floats, Number
from .hyperelastic import Hyperelastic, UncoupledHyperelastic, columns
from .registry import register


@dataclass(eq=False)
class Gent(UncoupledHyperelastic):
    """W~ = -G Jm ln(1 - (I1~ - 3)/Jm) / 2. Gent, Rubber Chem. Technol. 69 (1996) 59."""

    G: Number = 0.0
    Jm: Number = 0.0
    parameters = ("G", "Jm")

    def derivatives(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        G, Jm = self.par(pts).T
        d = Jm - I1 + 3.0
        return columns(pts, 0.5 * G * Jm / d, 0.0, 0.5 * G * Jm / d**2)

    def potential(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        G, Jm = self.par(pts).T
        return -0.5 * G * Jm * np.log1p(-(I1 - 3.0) / Jm)


@dataclass(eq=False)
class CompressibleGent(Hyperelastic):
    """sigma = G Jm / (Jm - I1 + 3) b / J + 2 K h^3 (J - 1/J) I, h = (J^2 - 1)/2 - ln J.

    As FEBio has it, with a stress where nothing is deformed.
    """

    G: Number = 0.0
    K: Number = 0.0
    Jm: Number = 0.0
    parameters = ("G", "K", "Jm")

    def derivatives(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        G, K, Jm = self.par(pts).T
        d, h, h1 = Jm - I1 + 3.0, 0.5 * (J**2 - 1.0) - np.log(J), J - 1.0 / J
        WJJ = 2.0 * K * (3.0 * h**2 * h1**2 + h**3 * (1.0 + 1.0 / J**2))
        return columns(pts, 0.5 * G * Jm / d, 0.0, 0.5 * G * Jm / d**2, 0.0, 0.0, 2.0 * K * h**3 * h1, WJJ)

    def potential(self, pts: Points, I1: Floats, I2: Floats, J: Floats) -> Floats:
        G, K, Jm = self.par(pts).T
        h = 0.5 * (J**2 - 1.0) - np.log(J)
        return -0.5 * G * Jm * np.log1p(-(I1 - 3.0) / Jm) + 0.5 * K * h**4


register(Gent, "Gent")
register(CompressibleGent, "compressible Gent")
