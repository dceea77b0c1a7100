"""What a law of solutes sees of the interstitial fluid: concentrations and partition at a batch of points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .sides import Sides

Floats = NDArray[np.float64]


@dataclass(slots=True)
class Solution:
    """n points, m solutes, b solid-bound molecules.

    z (m,) charge numbers; c, ca (n, m) effective and actual concentrations, ca = kappa c; kappa (n, m) partition
    coefficients with derivatives dkdJ (n, m) by J and dkdc (n, m, m) by c, last index the variable; phi0 (n,)
    referential solid volume fraction, solid-bound molecules included; cF (n,) fixed charge density per fluid
    volume; bound (n, b) referential apparent densities of solid-bound molecules, molar (b,) their molar masses,
    bound_charge (b,) charge numbers, bound_density (b,) true densities; fixed (1|n, m): solutes that do not diffuse,
    which belong to the solid; memory: what rate laws remember of each point; sides: what is on the faces of a membrane.
    """

    z: Floats
    c: Floats
    ca: Floats
    kappa: Floats
    dkdJ: Floats
    dkdc: Floats
    phi0: Floats
    cF: Floats
    bound: Floats
    molar: Floats
    bound_charge: Floats
    bound_density: Floats
    fixed: NDArray[np.bool_]
    memory: dict[int, Floats] = field(default_factory=dict)
    sides: Sides | None = None

    @property
    def m(self) -> int:
        return self.c.shape[1]

    def bound_concentration(self, J: Floats) -> Floats:
        """Concentrations of solid-bound molecules per fluid volume (n, b): rho_r / ((J - phi0) M)."""
        return self.bound / (J - self.phi0)[:, None] / self.molar

    def areal_concentration(self, J: Floats) -> Floats:
        """Moles of solid-bound molecules per area of a membrane (n, b): rho_r h / (J M)."""
        assert self.sides is not None
        return self.bound * (self.sides.h / J)[:, None] / self.molar

    def by_concentration(self, i: int) -> Floats:
        """Derivatives of ca_i by all effective concentrations (n, m): kappa_i delta_ij + c_i dkappa_i/dc_j."""
        out = self.c[:, i : i + 1] * self.dkdc[:, i]
        out[:, i] += self.kappa[:, i]
        return out

    def osmolarity(self) -> Floats:
        """Sum of the actual concentrations of what diffuses (n,)."""
        return np.where(self.fixed, 0.0, self.ca).sum(axis=1)

    @classmethod
    def at(cls, z: Floats, c: Floats, phi0: Floats, bound: Floats | None = None, molar: Floats | None = None,
           bound_charge: Floats | None = None, bound_density: Floats | None = None) -> Solution:  # fmt: skip
        """A solution that knows no partition yet: kappa = 1."""
        n, m = c.shape
        b = 0 if bound is None else bound.shape[1]
        return cls(
            np.asarray(z, float), c, c.copy(), np.ones((n, m)), np.zeros((n, m)), np.zeros((n, m, m)), phi0,
            np.zeros(n), np.zeros((n, 0)) if bound is None else bound, np.ones(b) if molar is None else molar,
            np.zeros(b) if bound_charge is None else bound_charge,
            np.ones(b) if bound_density is None else bound_density, np.zeros((1, m), bool),
        )  # fmt: skip
