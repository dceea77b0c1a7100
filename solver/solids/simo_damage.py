"""Solids softened by the largest strain energy they have borne.

Simo, Comput. Methods Appl. Mech. Eng. 60 (1987) 153.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..points import Points
from .base import Floats, Number, Solid, unwritten
from .mooney_rivlin import MooneyRivlin
from .neo_hookean import NeoHookean
from .registry import register


def peak_of(pts: Points, at: int, W: Floats) -> Floats:
    """The largest (2 W)^1/2 so far (n,), kept in column ``at`` of the history."""
    peak = np.sqrt(2.0 * np.abs(W))
    if pts.old is not None:
        peak = np.maximum(peak, pts.old[:, at])
    if pts.new is not None:
        pts.new[:, at] = peak
    return peak


def quartic(peak: Floats, beta: Floats, smin: Floats, smax: Floats) -> Floats:
    """g = 1 - (1 - beta + beta x^2) x^2, x = (peak - smin) / (smax - smin); 1 below smin, 0 above smax."""
    with np.errstate(divide="ignore", invalid="ignore"):  # smin = smax: all at once
        x2 = ((peak - smin) / (smax - smin)) ** 2
    return np.where(peak < smin, 1.0, np.where(peak > smax, 0.0, 1.0 - (1.0 - beta + beta * x2) * x2))


@dataclass(eq=False)
class _Softened(Solid):
    """g(peak) times the undamaged solid, peak the largest (2 W)^1/2 so far.

    The tangent leaves out how g changes, as in FEBio.

    History: peak.
    """

    consistent = False
    history = 1

    def reduction(self, pts: Points, peak: Floats) -> Floats:
        """g (n,)."""
        raise NotImplementedError

    def _largest(self, pts: Points, W: Floats) -> Floats:
        return peak_of(pts, self.offset, W)

    def _add(self, pts: Points, W: Floats, s: Floats, c: Floats | None, stress: object) -> None:
        """Add g times the stress and tangent that ``stress`` adds."""
        g = self.reduction(pts, self._largest(pts, W))
        own, tangent = np.zeros_like(s), None if c is None else np.zeros_like(c)
        stress(pts, own, tangent)  # type: ignore[operator]
        s += g[:, None] * own
        if c is not None and tangent is not None:
            c += g[:, None, None] * tangent

    def broken(self, pts: Points) -> Floats | float:
        return 0.0 if pts.new is None else 1.0 - self.reduction(pts, pts.new[:, self.offset])


@dataclass(eq=False)
class DamagedNeoHookean(_Softened, NeoHookean):
    """g = b + (1 - b) (1 - exp(-peak/a)) / (peak/a)."""

    a: Number = 0.014
    b: Number = 0.34
    parameters: ClassVar[tuple[str, ...]] = ("E", "v", "a", "b")

    def reduction(self, pts: Points, peak: Floats) -> Floats:
        a, b = self.par(pts).T[2:]
        x = np.where(peak > 1e-12, peak / a, 1.0)
        return np.where(peak > 1e-12, b - (1.0 - b) * np.expm1(-x) / x, 1.0 - 0.5 * (1.0 - b) / a * peak)

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, NeoHookean.energy(self, pts), s, c, super().stress)

    def energy(self, pts: Points) -> Floats:
        W = NeoHookean.energy(self, pts)
        return W * self.reduction(pts, self._largest(unwritten(pts), W))


@dataclass(eq=False)
class DamagedMooneyRivlin(_Softened, MooneyRivlin):
    """g as :func:`quartic` has it."""

    beta: Number = 0.1
    smin: Number = 0.0
    smax: Number = 0.5
    parameters = ("c1", "c2", "beta", "smin", "smax")

    def reduction(self, pts: Points, peak: Floats) -> Floats:
        return quartic(peak, *self.par(pts).T[2:])

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        self._add(pts, MooneyRivlin.dev_energy(self, pts), s, c, super().dev)

    def dev_energy(self, pts: Points) -> Floats:
        W = MooneyRivlin.dev_energy(self, pts)
        return W * self.reduction(pts, self._largest(unwritten(pts), W))

    stress = MooneyRivlin.stress
    energy = MooneyRivlin.energy


register(DamagedNeoHookean, "damage neo-Hookean")
register(DamagedMooneyRivlin, "damage Mooney-Rivlin")
