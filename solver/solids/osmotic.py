"""Osmotic pressures of cells and charged matrices as hydrostatic solids."""

from __future__ import annotations

from dataclasses import field

import numpy as np

from ..points import Points
from ..record import variable_record
from ..values import as_value
from .base import Floats, Number, Solid, wanted
from .ellipsoidal_fibers import EllipsoidalFibers
from .registry import register
from .uncoupled import add_volumetric


@variable_record
class _Osmotic(Solid):
    """sigma = -p(J) I; R and T are the file's gas constant and absolute temperature."""

    R: float = field(default=0.0, kw_only=True)
    T: float = field(default=0.0, kw_only=True)
    constants = ("R", "T")

    def pressure(self, pts: Points) -> tuple[Floats, Floats]:
        """p and dp/dJ (n,), per R T."""
        raise NotImplementedError

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        p, dp = self.pressure(pts)
        RT = self.R * self.T
        add_volumetric(pts.J, -RT * p, -RT * dp, s, wanted(c))


@variable_record
class PerfectOsmometer(_Osmotic):
    """p = R T (iosm phiw0 / (J - 1 + phiw0) - bosm)."""

    phiw0: Number = 0.0
    iosm: Number = 0.0
    bosm: Number = 0.0
    parameters = ("phiw0", "iosm", "bosm")

    def pressure(self, pts: Points) -> tuple[Floats, Floats]:
        phi, iosm, bosm = self.par(pts).T
        d = pts.J - 1.0 + phi
        return iosm * phi / d - bosm, -iosm * phi / d**2


@variable_record
class CellGrowth(_Osmotic):
    """p = R T (cr / (J - phir) - ce). Ateshian et al., J. Biomech. Eng. 131 (2009) 101001."""

    phir: Number = 0.0
    cr: Number = 0.0
    ce: Number = 0.0
    parameters = ("phir", "cr", "ce")

    def pressure(self, pts: Points) -> tuple[Floats, Floats]:
        phi, cr, ce = self.par(pts).T
        d = pts.J - phi
        return cr / d - ce, -cr / d**2


@variable_record
class Donnan(_Osmotic):
    """p = R T Phi ((cF^2 + bosm^2)^1/2 - bosm), cF = phiw0 cF0 / (J - 1 + phiw0).

    phis0 >= 0 gives the solid's share instead: phiw0 = 1 - phis0(t = 0), and J - phis0(t) below the line.
    Ateshian et al., J. Biomech. 39 (2006) 464.
    """

    phiw0: Number = -1.0
    phis0: Number = -1.0
    cF0: Number = 0.0
    bosm: Number = 0.0
    Phi: Number = 1.0
    parameters = ("phiw0", "phis0", "cF0", "bosm", "Phi")

    def pressure(self, pts: Points) -> tuple[Floats, Floats]:
        phiw, phis, cF0, bosm, Phi = self.par(pts).T
        first = as_value(self.phis0)(0.0, pts.X, pts.e)
        phiw = np.where(first >= 0, 1.0 - first, phiw)
        d = pts.J - np.where(first >= 0, phis, 1.0 - phiw)
        cF = phiw * cF0 / d
        root = np.sqrt(cF**2 + bosm**2)
        return Phi * (root - bosm), -Phi * cF**2 / (d * np.where(root == 0, 1.0, root))


@variable_record
class VirialExpansion(Solid):
    """sigma = -(c1 c + c2 c^2 + c3 c^3) I, c = phiw0 cr / (J - 1 + phiw0)."""

    phiw0: Number = 0.0
    cr: Number = 0.0
    c1: Number = 0.0
    c2: Number = 0.0
    c3: Number = 0.0
    parameters = ("phiw0", "cr", "c1", "c2", "c3")

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        phi, cr, c1, c2, c3 = self.par(pts).T
        d = pts.J - 1.0 + phi
        x = phi * cr / d
        slope = (c1 + 2.0 * c2 * x + 3.0 * c3 * x * x) * x / d
        add_volumetric(pts.J, -(c1 + c2 * x + c3 * x * x) * x, slope, s, wanted(c))


@variable_record
class EllipsoidalDonnan(EllipsoidalFibers):
    """A charged matrix with ellipsoidally distributed fibers, summed over a geodesic dome as FEBio does here."""

    phiw0: Number = -1.0
    cF0: Number = 0.0
    bosm: Number = 0.0
    Phi: Number = 1.0
    R: float = field(default=0.0, kw_only=True)
    T: float = field(default=0.0, kw_only=True)
    parameters = ("phiw0", "cF0", "bosm", "Phi", "beta", "ksi")
    constants = ("R", "T")
    dome = True

    def stress(self, pts: Points, s: Floats, c: Floats | None) -> None:
        matrix = Donnan(self.phiw0, -1.0, self.cF0, self.bosm, self.Phi, R=self.R, T=self.T)
        matrix.stress(pts, s, c)
        self.fibers(pts, s, c)


register(PerfectOsmometer, "perfect osmometer")
register(CellGrowth, "cell growth")
register(Donnan, "Donnan equilibrium")
register(EllipsoidalDonnan, "EFD Donnan equilibrium")
register(VirialExpansion, "osmotic virial expansion")
