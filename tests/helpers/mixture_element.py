"""One distorted element of a mixture, with its residual as a function of nodal unknowns."""

from __future__ import annotations

from typing import Any

import numpy as np

from febkit.solver import (
    diffusivities,
    elements,
    osmotic_coefficients,
    permeabilities,
    reaction_rates,
    solubilities,
)
from febkit.solver.kernels import solid
from febkit.solver.multiphasic.fields import Fields, Instant
from febkit.solver.multiphasic.integrals import at_points, forces, matrices, operators
from febkit.solver.multiphasic.material import Mixture
from febkit.solver.multiphasic.species import SolidBound, Solute
from febkit.solver.multiphasic.tangent import point_tangent
from febkit.solver.points import Points
from febkit.solver.solids.registry import load
from febkit.solver.values import Constant

RNG = np.random.default_rng(11)


class Wells:
    """1 - x / 10 + x^2 / 50."""

    def value(self, x: np.ndarray) -> np.ndarray:
        return 1.0 - 0.1 * x + 0.02 * x * x

    def slope(self, x: np.ndarray) -> np.ndarray:
        return -0.1 + 0.04 * x


def solute(i: int, charge: int, diffusivity: str = "diff-const-iso", **parameters: Any) -> Solute:
    law = diffusivities.load(diffusivity)(**(parameters or {"free_diff": 1.3 + 0.2 * i, "diff": 0.7 + 0.1 * i}))
    solubility = solubilities.load("solub-const")(solub=0.9 - 0.1 * i)
    return Solute(f"s{i}", i, law, solubility, charge, 2.0 + i, 3.0 + i)


def mixture(solutes: tuple[Solute, ...], **more: Any) -> Mixture:
    k = permeabilities.load("perm-ref-iso")(perm0=0.3, perm1=0.2, perm2=0.1, M=0.5, alpha=1.2)
    given = {"phi0": Constant(0.2), "fixed_charge": Constant(-0.4), "R": 1.1, "T": 1.2, "Fc": 1.3} | more
    return Mixture(
        given.pop("permeability", k), osmotic_coefficients.load("osm-coef-const")(osmcoef=0.95), solutes, **given
    )


def rate(name: str = "constant reaction rate", **parameters: Any) -> Any:
    return reaction_rates.load(name)(**(parameters or {"k": 0.3}))


def bound(i: int, charge: int) -> SolidBound:
    return SolidBound(f"b{i}", i, charge, 1.5, 6.0, Constant(0.3 + 0.1 * i))


class Element:
    """A hex8 of neo-Hookean solid and ``mix``; unknowns x (C n,), component-major."""

    def __init__(self, mix: Mixture, steady: bool = False, dt: float = 0.7) -> None:
        e = elements.get("hex8", None)
        self.N, self.dN = np.ascontiguousarray(e.N), np.ascontiguousarray(e.dN)
        corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1.0]])
        X = corners + 0.1 * RNG.uniform(-1, 1, (8, 3))
        self.conn = np.arange(8, dtype=np.int32)[None]
        g = len(e.weights)
        self.iJ0, self.wJ0 = np.empty((1, g, 3, 3)), np.empty((1, g))
        solid.reference(X, self.conn, self.dN, np.ascontiguousarray(e.weights), self.iJ0, self.wJ0)
        self.F, self.J = np.tile(np.eye(3), (1, g, 1, 1)), np.ones((1, g))
        self.mix, self.law = mix, load("solid", "neo-Hookean")(E=2.0, v=0.2)
        self.pts = Points(self.F.reshape(-1, 3, 3), self.J.reshape(-1), np.zeros((g, 3)), np.zeros(g, dtype=int))
        self.now, self.C = Instant(dt, steady), 4 + len(mix.solutes)
        self.fields = Fields(mix, self.pts)
        self._set(self.start(), None)
        self.fields.begin_step(self.pts)

    def start(self) -> np.ndarray:
        x = np.zeros((self.C, 8))
        x[4:] = 0.6
        return x.ravel()

    def state(self) -> np.ndarray:
        x = self.start().reshape(self.C, 8)
        x[:3] += 0.1 * RNG.uniform(-1, 1, (3, 8))
        x[3:] += 0.2 * RNG.uniform(-1, 1, (self.C - 3, 8))
        return x.ravel()

    def _set(self, x: np.ndarray, now: Instant | None) -> None:
        d = x.reshape(self.C, 8).T
        assert solid.kinematics(0, 1, np.ascontiguousarray(d[:, :3]), self.conn, self.dN, self.iJ0, self.F, self.J) < 0
        self.B = operators(0, 1, self.N, self.dN, self.iJ0, self.F, self.J)
        self.fields.update(slice(None), self.pts, at_points(self.B, d[None, :, 3:]), now)

    def force(self, x: np.ndarray, passes: int = 1) -> np.ndarray:
        """Internal forces at x. ``passes`` > 1 lets what lags within an iteration catch up."""
        for _ in range(passes):
            self._set(x, self.now)
        s = np.zeros((self.pts.n, 6))
        self.law.stress(self.pts, s, None)
        stress = self.fields.stress(slice(None), self.pts, s, self.now)
        return forces(self.B, self.wJ0 * self.J, stress).ravel()

    def tangent(self, x: np.ndarray, passes: int = 1, consistent: bool = False) -> np.ndarray:
        for _ in range(passes):
            self._set(x, self.now)
        s, C = np.zeros((self.pts.n, 6)), np.zeros((self.pts.n, 6, 6))
        self.law.stress(self.pts, s, C)
        A = point_tangent(self.fields, slice(None), self.pts, s, C, self.now, consistent)
        return matrices(self.B, self.wJ0 * self.J, A)[0]

    def differences(self, x: np.ndarray, h: float = 1e-6, passes: int = 1) -> np.ndarray:
        K = np.empty((len(x), len(x)))
        for k in range(len(x)):
            step = np.zeros_like(x)
            step[k] = h
            K[:, k] = (self.force(x + step, passes) - self.force(x - step, passes)) / (2 * h)
        return K

    def block(self, K: np.ndarray, row: str, column: str) -> np.ndarray:
        at = {"u": slice(0, 24), "p": slice(24, 32), "c": slice(32, None)}
        return K[at[row], at[column]]
