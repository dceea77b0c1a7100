"""Solids with one fiber direction a0 given by derivatives of W(I1, I2, I4, I5, J)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..points import Points
from .base import Floats, Property, Solid
from .fiber import directions
from .secant import central_tangent
from .uncoupled import Uncoupled
from .voigt import deviator, vector


def spatial(pts: Points, a0: Floats, iso: bool) -> dict[str, Floats]:
    """b, b^2, n dyad n, sym(n dyad b n), n the unit direction, and I1, I2, I4, I5; of F~ where ``iso``."""
    F = pts.F * pts.J[:, None, None] ** (-1.0 / 3.0) if iso else pts.F
    b = F @ np.swapaxes(F, 1, 2)
    b2 = b @ b
    a = np.einsum("nij,nj->ni", F, np.broadcast_to(a0, (pts.n, 3)))
    I4 = (a**2).sum(1)
    n = a / np.sqrt(I4)[:, None]
    bn = np.einsum("nij,nj->ni", b, n)
    I1 = np.trace(b, axis1=1, axis2=2)
    mixed = n[:, :, None] * bn[:, None, :]
    return {
        "b": b,
        "b2": b2,
        "N": n[:, :, None] * n[:, None, :],
        "M": mixed + np.swapaxes(mixed, 1, 2),
        "I1": I1,
        "I2": 0.5 * (I1**2 - np.trace(b2, axis1=1, axis2=2)),
        "I4": I4,
        "I5": I4 * (n * bn).sum(1),
    }


@dataclass(eq=False)
class FourthInvariant(Solid):
    """sigma = 2/J [(W1 + I1 W2) b - W2 b^2 + I4 W4 n n + I4 W5 (n bn + bn n)] + WJ I; tangent by differences."""

    iso = False
    fiber: Any = field(default=None, kw_only=True)
    properties = {"fiber": Property("direction", default="vector")}

    def derivatives(self, pts: Points, i: dict[str, Floats]) -> tuple[Floats | float, ...]:
        """W1, W2, W4, W5 and, where compressible, WJ."""
        raise NotImplementedError

    def _cauchy(self, pts: Points) -> Floats:
        i = spatial(pts, directions(self.fiber, pts), self.iso)
        W1, W2, W4, W5, *WJ = (np.broadcast_to(w, (pts.n,))[:, None, None] for w in self.derivatives(pts, i))
        I1, I4 = i["I1"][:, None, None], i["I4"][:, None, None]
        T = (W1 + W2 * I1) * i["b"] - W2 * i["b2"] + I4 * W4 * i["N"] + I4 * W5 * i["M"]
        s = 2.0 / pts.J[:, None, None] * (deviator(T) if self.iso else T)
        return vector(s + WJ[0] * np.eye(3) if WJ else s)

    def _add(self, pts: Points, s: Floats, c: Floats | None) -> None:
        within = self.inner(pts)
        s += self._cauchy(within)
        if c is not None:
            c += central_tangent(self._cauchy, within)

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c)


@dataclass(eq=False)
class UncoupledFourthInvariant(FourthInvariant, Uncoupled):
    """The deviatoric part, of F~."""

    iso = True

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, s, c)

    stress = Uncoupled.stress
    energy = Uncoupled.energy
