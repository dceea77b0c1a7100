"""Nearly incompressible Arruda-Boyce solid."""

from __future__ import annotations

from dataclasses import dataclass

from ..points import Points
from .base import Floats, Number
from .hyperelastic import UncoupledHyperelastic, columns
from .registry import register

_A = (1 / 2, 1 / 10, 11 / 350, 19 / 1750, 519 / 134750)


@dataclass(eq=False)
class ArrudaBoyce(UncoupledHyperelastic):
    """W~ = mu sum_i a_i (I1~^i - 3^i) / N^(i-1), five terms. Arruda & Boyce, J. Mech. Phys. Solids 41 (1993) 389."""

    mu: Number = 0.0
    N: Number = 1.0
    parameters = ("mu", "N")

    def derivatives(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        mu, N = self.par(pts).T
        W1 = mu * sum((i + 1) * a * (I1 / N) ** i for i, a in enumerate(_A))
        W11 = mu / N * sum(i * (i + 1) * a * (I1 / N) ** (i - 1) for i, a in enumerate(_A) if i)
        return columns(pts, W1, 0.0, W11)

    def potential(self, pts: Points, I1: Floats, I2: Floats) -> Floats:
        mu, N = self.par(pts).T
        return mu * sum(a * (I1 ** (i + 1) - 3.0 ** (i + 1)) / N**i for i, a in enumerate(_A))


register(ArrudaBoyce, "Arruda-Boyce")
