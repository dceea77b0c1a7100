"""Fung's exponential orthotropic solids."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from ..points import Points
from ..values import as_value
from .base import Floats, Number, wanted
from .orthotropic import Engineering, LocalStrain, linear
from .registry import register
from .uncoupled import Uncoupled, add_volumetric


@dataclass(eq=False)
class _Fung(Engineering):
    c: Number = field(default=1.0, kw_only=True)
    parameters: ClassVar[tuple[str, ...]] = (*Engineering.parameters, "c")

    def law(self, pts: Points, E: Floats) -> tuple[Floats, Floats, Floats]:
        par = self.par(pts)  # type: ignore[attr-defined]
        D, c = self.stiffness(par), par[:, 9]
        S, half = linear(E, D)
        e = np.exp(2.0 * half / c)
        k = (2.0 / c * e)[:, None, None]
        return e[:, None] * S, e[:, None, None] * D + k * S[:, :, None] * S[:, None, :], 0.5 * c * (e - 1.0)


@dataclass(eq=False)
class FungOrthotropic(_Fung, LocalStrain, Uncoupled):
    """W~ = c (exp[E~ : D : E~ / c] - 1) / 2. Fung, Am. J. Physiol. 237 (1979) H620, Ateshian & Costa (2009)."""

    iso = True

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c)

    def dev_energy(self, pts: Points) -> Floats:
        return self.law(pts, self._strain(pts))[2]

    stress = Uncoupled.stress
    energy = Uncoupled.energy


@dataclass(eq=False)
class FungOrthotropicCompressible(_Fung, LocalStrain):
    """W = c (exp[E : D : E / c] - 1) / 2 + k (ln J)^2 / 2."""

    k: Number = field(default=0.0, kw_only=True)
    parameters = (*_Fung.parameters, "k")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c)
        k, lnJ = as_value(self.k)(pts.t, pts.X, pts.e), np.log(pts.J)
        add_volumetric(pts.J, k * lnJ / pts.J, k * (1.0 - lnJ) / pts.J**2, s, wanted(c))

    def energy(self, pts: Points) -> Floats:
        k = as_value(self.k)(pts.t, pts.X, pts.e)
        return self.law(pts, self._strain(pts))[2] + 0.5 * k * np.log(pts.J) ** 2


register(FungOrthotropic, "Fung orthotropic")
register(FungOrthotropicCompressible, "Fung-ortho-compressible")
