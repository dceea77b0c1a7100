"""Rates by the strain energy of the solid."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from ..law import Floats, Number
from ..multiphasic.solution import Solution
from ..points import Points
from ..solids.bound import Bound
from ..solids.fiber import Fiber, directions
from ..solids.solid_mixture import SolidMixture
from . import register
from .base import ReactionRate


@dataclass(eq=False)
class Strained(ReactionRate):
    """What is kept of each point is the strain energy density W of the solid, as of the last evaluation."""

    root: Any = field(default=None, init=False, repr=False)  # the material's solid
    bearer: Any = field(default=None, init=False, repr=False)  # the solid whose energy counts
    remembers: ClassVar[bool] = True

    def attach(self, solid: Any, used: Floats, made: Floats, molar: Floats) -> None:
        self.root = self.bearer = solid
        if not isinstance(solid, Bound):
            raise ValueError("the solid must be Carter-Hayes or a fiber of a solid-bound molecule")

    def evaluated(self, pts: Points, kept: Floats) -> None:
        kept[:] = self.bearer.energy(pts if self.bearer is self.root else self.root.inner(pts))


@dataclass(eq=False)
class Huiskes(Strained):
    """k = B (W / rho - psi0) / ((J - phi0) M), rho the referential density of all that is solid, M the molar mass of
    the product.

    W is that of the solid whose stiffness goes by the product. Sensors sense the point they are at (D = 0). FEBio User
    Manual, "Huiskes Reaction Rate"; Weinans, Huiskes & Grootenboer, J. Biomech. 25 (1992) 1425.
    """

    B: Number = 0.0
    psi0: Number = 0.0
    D: float = 0.0
    M: float = field(default=1.0, init=False)
    parameters = ("B", "psi0")

    def attach(self, solid: Any, used: Floats, made: Floats, molar: Floats) -> None:
        if not made.any():
            raise ValueError("the first vP must be a solid-bound molecule")
        product = int(np.flatnonzero(made)[0])
        self.root, self.M = solid, float(molar[product])
        among = solid.solid if isinstance(solid, SolidMixture) else [solid]
        own = [s for s in among if isinstance(s, Bound) and s.sbm == product]
        if not own:
            raise ValueError("no solid of the material goes by the density of the product")
        self.bearer = own[-1]

    def rate(self, pts: Points, sol: Solution) -> Floats:
        B, psi0 = self.par(pts).T
        rho = sol.phi0 * self.root.density(pts) + sol.bound.sum(axis=1)
        return np.asarray(B * (sol.memory[id(self)] / rho - psi0) / (pts.J - sol.phi0) / self.M)

    def by_J(self, pts: Points, sol: Solution) -> Floats:
        return -self.rate(pts, sol) / (pts.J - sol.phi0)


@dataclass(eq=False)
class ExpSED(Strained):
    """k = B exp(W / Psi0) / (J - phi0). FEBio 4.11, "exp-sed reaction rate"."""

    B: Number = 0.0
    Psi0: Number = 0.0
    parameters = ("B", "Psi0")

    def rate(self, pts: Points, sol: Solution) -> Floats:
        B, Psi0 = self.par(pts).T
        return np.asarray(B * np.exp(sol.memory[id(self)] / Psi0) / (pts.J - sol.phi0))

    def by_J(self, pts: Points, sol: Solution) -> Floats:
        return -self.rate(pts, sol) / (pts.J - sol.phi0)


@dataclass(eq=False)
class Ruberti(ReactionRate):
    """k = kd exp(-((l - 1) / sigma)^2 / 2) where the fibers' stretch l is above 1, else kd: strain protects them.

    The fibers are those of the mixture of solids that go by the density of the reactant. FEBio 4.11, "Ruberti
    reaction rate"; Wyatt, Bourne & Torzilli, J. Biomech. Eng. 131 (2009) 051004.
    """

    kd: Number = 0.0
    sigma: Number = 0.0
    root: Any = field(default=None, init=False, repr=False)
    fibers: Any = field(default=None, init=False, repr=False)
    parameters = ("kd", "sigma")

    def attach(self, solid: Any, used: Floats, made: Floats, molar: Floats) -> None:
        if not used.any():
            raise ValueError("the first vR must be a solid-bound molecule")
        reactant = int(np.flatnonzero(used)[0])
        among = solid.solid if isinstance(solid, SolidMixture) else ()
        own = [s for s in among if isinstance(s, Bound) and isinstance(s, Fiber) and s.sbm == reactant]
        if not own:
            raise ValueError("no fibers of a solid mixture go by the density of the reactant")
        self.root, self.fibers = solid, own[-1]

    def rate(self, pts: Points, sol: Solution) -> Floats:
        kd, sigma = self.par(pts).T
        a = directions(self.fibers.fiber, self.fibers.inner(self.root.inner(pts)))
        stretch = np.linalg.norm(np.einsum("nij,nj->ni", pts.F, np.broadcast_to(a, (pts.n, 3))), axis=1)
        return np.where(stretch > 1.0, kd * np.exp(-0.5 * ((stretch - 1.0) / sigma) ** 2), kd)


register(Huiskes, "Huiskes reaction rate")
register(ExpSED, "exp-sed reaction rate")
register(Ruberti, "Ruberti reaction rate")
