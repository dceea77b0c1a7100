"""Mooney-Rivlin solid with fibers, both softened by the largest strain energy they have borne."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.fibers import add_fibers, squared_stretch
from ..points import Points
from .base import Floats, Number, unwritten, wanted
from .fiber import directions
from .invariants import isochoric_invariants
from .mooney_rivlin import MooneyRivlin, run
from .registry import register
from .simo_damage import peak_of, quartic


@dataclass(eq=False)
class DamagedTransIso(MooneyRivlin):
    """W~ = gm [c1 (I1~ - 3) + c2 (I2~ - 3)] + gf c3 / (2 c4) (exp[c4 (I4~ - 1)^2] - 1).

    gm and gf fall as that of "damage Mooney-Rivlin", each with the largest (2 W)^1/2 of its part; fibers lie along the
    first material axis and bear compression, too. The tangent leaves out how they fall. History: the two peaks.
    """

    consistent = False
    c3: Number = 0.0
    c4: Number = 0.0
    Mbeta: Number = 0.0
    Msmin: Number = 0.0
    Msmax: Number = 0.0
    Fbeta: Number = 0.0
    Fsmin: Number = 0.0
    Fsmax: Number = 0.0
    parameters = ("c1", "c2", "c3", "c4", "Mbeta", "Msmin", "Msmax", "Fbeta", "Fsmin", "Fsmax")
    history = 2

    def _along(self, pts: Points) -> tuple[Floats, Floats]:
        """Fiber directions (1|n, 1, 3) and I4~ (n, 1)."""
        A, In = directions(None, self.inner(pts))[:, None], np.empty((pts.n, 1))
        squared_stretch(pts.F, pts.J, A, True, In)
        return A, In

    def _energies(self, pts: Points, In: Floats) -> Floats:
        """Of the matrix and of the fibers, undamaged (2, n)."""
        c1, c2, c3, c4 = self.par(pts).T[:4]
        I1, I2 = isochoric_invariants(pts)
        fibers = 0.5 * c3 / c4 * np.expm1(c4 * (In[:, 0] - 1.0) ** 2)
        return np.stack((c1 * (I1 - 3.0) + c2 * (I2 - 3.0), fibers))

    def _reductions(self, pts: Points, W: Floats) -> Floats:
        """gm and gf (2, n)."""
        par = self.par(pts).T[4:].reshape(2, 3, -1)
        return np.stack([quartic(peak_of(pts, self.offset + k, W[k]), *par[k]) for k in range(2)])

    def dev(self, pts: Points, s: Floats, c: Floats | None) -> None:
        A, In = self._along(pts)
        gm, gf = self._reductions(pts, self._energies(pts, In))
        own, tangent = np.zeros_like(s), None if c is None else np.zeros_like(c)
        run(pts.F, pts.J, self.par(pts), own, wanted(tangent))
        s += gm[:, None] * own
        if c is not None and tangent is not None:
            c += gm[:, None, None] * tangent
        _, _, c3, c4 = self.par(pts).T[:4, :, None]
        x = In - 1.0
        e = gf[:, None] * c3 * np.exp(c4 * x * x)
        sn, cn = 2.0 * In * x * e, 4.0 * In * In * e * (1.0 + 2.0 * c4 * x * x)
        add_fibers(pts.F, pts.J, A, np.ones((1, 1)), In, sn, cn, np.empty((0, 0)), True, s, wanted(c))

    def dev_energy(self, pts: Points) -> Floats:
        W = self._energies(pts, self._along(pts)[1])
        return (self._reductions(unwritten(pts), W) * W).sum(axis=0)

    def broken(self, pts: Points) -> Floats | float:
        """Of the matrix and of the fibers, added up as FEBio does."""
        return 2.0 - self._reductions(unwritten(pts), self._energies(pts, self._along(pts)[1])).sum(axis=0)


register(DamagedTransIso, "damage trans iso Mooney-Rivlin")
