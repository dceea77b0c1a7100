"""When a nonlinear solve has converged: FEBio's norms and tests, the same for every way of solving a step.

Norms are squared, as FEBio prints them. Each nodal field is tested apart: |s u|^2 <= tol^2 |U|^2 for the increment s u
of an iteration and U of the step. FEBio source: the loops of FEBioMech and FEBioMix (facts alone).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from .finite import NotFinite
from .problem import NewtonOptions
from .system import System
from .vectors import dot

Floats = NDArray[np.float64]


class NotConverged(RuntimeError):
    """This time step did not converge; the message says why, in words for the user."""


@dataclass(slots=True, eq=False)
class Norm:
    """Squared norms: of the first iteration, of this one, and what it must not exceed."""

    initial: float
    now: float
    required: float


@dataclass(slots=True, eq=False)
class Iteration:
    """What one iteration reports: counters, line search step and norms."""

    time: float
    number: int
    updates: int
    residuals: int
    reforms: int
    line: float
    norms: dict[str, Norm]


class Convergence:
    """The tests of one time step after another; ``least`` is the squared residual that counts as none."""

    def __init__(self, system: System, options: NewtonOptions) -> None:
        self.system, self.options = system, options
        self.least = options.min_residual
        parts = [(f, system.layout.equations(f, system.eqs.column)) for f in system.layout.normed]
        self.fields = [
            (f, slice(None) if len(own) == system.eqs.n else own, options.tolerance(f)) for f, own in parts
        ]
        # FEBio's norms of mixtures count a rigid body's displacement once for each node it carries, its rotation never
        self.weight: Floats | None = None
        if len(self.fields) > 1 and system.bodies is not None:
            self.weight = np.sqrt(system.bodies.counted(system.eqs))
        self.begin()

    def begin(self) -> None:
        """A time step begins: its first iteration sets the scales."""
        self.first: list[float] | None = None  # squared norms of the first increment, field by field
        self.energy = self.most = self.residual = 0.0

    def test(self, u: Floats, s: float, R0: Floats, R1: Floats, U: Floats) -> tuple[dict[str, Norm], bool]:
        """The norms after the step s u from residual R0 to R1, U being the step's increment with it; small enough?

        Raises NotFinite where a norm overflows.
        """
        if self.first is None:
            self.scale(u, R0)
        report, ok = self._norms(u, s, R1, U)
        for name, norm in report.items():  # of numbers too large to be squared: no test on them means anything
            if not (isfinite(norm.initial) and isfinite(norm.now)):
                raise NotFinite(f"the norm of the {name} overflows: the numbers of the model are too large")
        return report, ok or report["residual"].now < self.least

    def scale(self, u: Floats, R0: Floats) -> None:
        """An increment u from residual R0 sets the scales."""
        self.residual, self.energy = dot(R0, R0), abs(dot(u, R0))
        self.most = self.energy
        self.first = [self._square(u, own) for _, own, _ in self.fields]

    def _norms(self, u: Floats, s: float, R1: Floats, U: Floats) -> tuple[dict[str, Norm], bool]:
        o, first = self.options, self.first or []
        energy, r1 = abs(s * dot(u, R1)), dot(R1, R1)
        report = {
            "residual": Norm(self.residual, r1, o.rtol * self.residual),
            "energy": Norm(self.energy, energy, o.etol * self.energy),
        }
        ok = not (o.rtol > 0 and r1 > o.rtol * self.residual)
        ok = ok and not (o.etol > 0 and energy > o.etol * self.energy)
        for (f, own, tol), start in zip(self.fields, first, strict=True):
            now, total = s * s * self._square(u, own), self._square(U, own)
            report[f.name] = Norm(start, now, tol * tol * total)
            ok = ok and not (tol > 0 and now > tol * tol * total)
        ok = ok and not (o.line_tolerance > 0 and s < o.line_minimum)
        ok = ok and not (o.diverge_reform and energy > self.most)
        # surfaces that met while nothing else moved: an increment of zero is no sign of balance
        ok = ok and not (self.system.contacts and r1 > self.residual and not U.any())
        return report, ok

    def _square(self, u: Floats, own: NDArray[np.int64] | slice) -> float:
        """Squared norm of a field's equations ``own``."""
        part = u[own] if self.weight is None else u[own] * self.weight[own]
        return dot(part, part)

    def diverged(self, report: dict[str, Norm]) -> bool:
        """Has the energy grown beyond all before? Then it is the scale from here on, as in FEBio."""
        energy = report["energy"].now
        if not (self.options.diverge_reform and energy > self.most):
            return False
        self.most = self.energy = energy
        self.residual = report["residual"].now
        return True
