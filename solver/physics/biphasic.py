"""A porous solid and the fluid in its pores: displacement and fluid pressure, backward Euler.

FEBio theory manual, "Biphasic" finite elements; what the integrals are is said in :mod:`..kernels.biphasic`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..fields import DISPLACEMENT, PRESSURE, Field
from ..kernels import biphasic, blocks, variations
from ..points import Points
from ..tangent import upper_blocks
from ..values import Constant, Value
from . import register
from .base import Floats, Physics, Work
from .standard import StandardWork
from .steadied import Steadied

if TYPE_CHECKING:
    from ..changes import Changes
    from ..group import Chunk, Group
    from ..state import State
    from ..tangent import Target, Workspace

_NONE, _CONSTANT = np.zeros((0, 0)), np.zeros((0, 6, 6))


@dataclass(slots=True, eq=False)
class _Laws:
    """What the laws of a chunk give at its points: stress and tangent of the solid, permeability, its tangent, supply
    with its derivatives."""

    s: Floats
    C: Floats
    k: Floats
    dk: Floats | None
    supply: tuple[Floats, Floats, Floats] | None

    def part(self, p: slice) -> _Laws:
        """Those of some of its points."""
        supply = None if self.supply is None else (self.supply[0][p], self.supply[1][p], self.supply[2][p])
        return _Laws(self.s[p], self.C[p], self.k[p], None if self.dk is None else self.dk[p], supply)


class BiphasicWork(StandardWork):
    """At the points: pressure pg (m, g), its gradient gp (m, g, 3), fluid flux w (m, g, 3), supply; Jp (m, g) is the
    relative volume at the last converged state."""

    memory: ClassVar[tuple[str, ...]] = ("s", "Jp", "pg", "gp", "w")

    held: ClassVar[Mapping[str, str]] = {
        **StandardWork.held, "pg": "fluid pressure", "w": "fluid flux", "supply": "fluid supply",
    }  # fmt: skip

    def __init__(self, group: Group, physics: Biphasic) -> None:
        super().__init__(group, physics)
        m, g = group.m, group.g
        self.mixture = physics
        self.Jp = np.ones((m, g))
        self.pg, self.gp, self.w = np.zeros((m, g)), np.zeros((m, g, 3)), np.zeros((m, g, 3))
        self.supply = np.zeros((m, g)) if physics.supply is not None else _NONE
        self.steadied = Steadied(group)

    def symmetric(self, steady: bool) -> bool:
        mix = self.mixture
        own = super().symmetric(steady) and not mix.permeability.strain_dependent and mix.supply is None
        return own and not steady

    @property
    def recalls(self) -> bool:
        return type(self) is not BiphasicWork or self.steadied.coefficient is not None

    def stabilise(self, tau: float) -> None:
        self.steadied.begin(tau)

    # ---- laws -------------------------------------------------------------------------------------
    def update(self, c: Chunk, state: State, drive: list[Any]) -> None:
        super().update(c, state, drive)
        g, mix = self.group, self.mixture
        self._pressures(c.lo, c.hi, state)
        k = self._permeability(c.points)[0]
        b = self._drive(c, drive) if drive or mix.active is not None else np.zeros((0, 3))
        biphasic.flux(c.lo, c.hi, k, self.gp, b, self.w)
        if mix.supply is not None:
            q = np.zeros(c.points.n)
            mix.supply.supply(c.points, self.pg[c.lo : c.hi].reshape(-1), q, None, None)
            self.supply[c.lo : c.hi] = q.reshape(-1, g.g)

    def _pressures(self, lo: int, hi: int, state: State) -> None:
        """Pressures and their gradients at the points of elements lo:hi."""
        g, p = self.group, np.ascontiguousarray(state.layout.scalar(state.d, PRESSURE.name))
        biphasic.pressures(lo, hi, g.conn, g.N, g.dN, g.iJ0, g.F, g.J, p, self.pg, self.gp)

    def _drive(self, c: Chunk, drive: list[Any]) -> Floats:
        b = np.zeros((c.points.n, 3))
        for load in drive:
            b += load.force(c.points)
        b *= self.mixture.fluid_density(c.points.t, c.points.X, c.points.e)[:, None]
        return b if self.mixture.active is None else b + self.mixture.active.drive(c.points)

    def _permeability(self, pts: Points, tangent: bool = False) -> tuple[Floats, Floats | None]:
        """Permeability (n, 6) at points, and where asked for its derivatives (n, 6, 6), None where it has none."""
        k = np.zeros((pts.n, 6))
        dk = np.zeros((pts.n, 6, 6)) if tangent and self.mixture.permeability.strain_dependent else None
        self._conduct(pts, k, dk)
        return k, dk

    def _supply_tangent(self, c: Chunk) -> tuple[Floats, Floats, Floats]:
        """Solvent supply of a chunk's points, and its derivatives by strain and pressure."""
        pts = c.points
        rate, dE, dp = np.zeros(pts.n), np.zeros((pts.n, 6)), np.zeros(pts.n)
        self.mixture.supply.supply(pts, self.pg[c.lo : c.hi].reshape(-1), rate, dE, dp)
        return rate, dE, dp

    # ---- residual and tangent ---------------------------------------------------------------------
    def residual(self, lo: int, hi: int, state: State, R: Floats, steady: bool) -> None:
        g = self.group
        Ru, Rp = state.layout.u(R), state.layout.scalar(R, PRESSURE.name)
        biphasic.internal_force(
            lo, hi, g.conn, g.N, g.dN, g.iJ0, g.wJ0, g.F, g.J, self.Jp, self.s, self.pg, self.w, self.supply,
            state.dt, steady, Ru, Rp,
        )  # fmt: skip
        if not steady:
            self.steadied.force(lo, hi, self.pg, Rp)

    def tangent(self, c: Chunk, state: State, target: Target, work: Workspace, steady: bool) -> None:
        q = (c.hi - c.lo) * self.group.g
        s, C = work.zeros("s", q, 6), work.zeros("C", q, 6, 6)
        c.points.t, c.points.dt = state.time, state.dt
        self.moduli(c, s, C)
        k, dk = self._permeability(c.points, tangent=True)
        supply = self._supply_tangent(c) if self.mixture.supply is not None else None
        laws = _Laws(s, C, k, dk, supply)
        for lo, hi, _, p in self.group.pieces(c):
            self._add_fluid(lo, hi, laws.part(p), state.dt, target, work, steady)

    def _add_fluid(
        self, lo: int, hi: int, laws: _Laws, dt: float, target: Target, work: Workspace, steady: bool
    ) -> None:  # fmt: skip
        """The tangents of elements lo:hi."""
        g, n, nd = self.group, hi - lo, 4 * self.group.n
        if g.block.solid.symmetric:
            B, U = upper_blocks(g, lo, hi, laws.s, laws.C, work, (self.pg, laws.k, dt))
            if not steady:
                self.steadied.tangent(lo, hi, B, 6 * g.n, 0)
            if target.pat.symmetric and laws.dk is None and laws.supply is None and not steady:
                target.add_blocks(g, lo, hi, B, U)
                return
            K = work.take("K", n, nd, nd)
            blocks.expand(n, B, U, steady, K)
        else:
            K = work.take("K", n, nd, nd)
            se, Ce = laws.s.reshape(-1, g.g, 6), laws.C.reshape(-1, g.g, 6, 6)
            biphasic.stiffness(lo, hi, g.N, *g.geometry, se, Ce, self.pg, laws.k, dt, steady, K)
            if not steady:
                self.steadied.tangent(lo, hi, K, 3 * g.n, 3 * g.n)
        if laws.dk is not None:
            biphasic.permeability_coupling(lo, hi, *g.geometry, self.gp, laws.dk, dt, steady, K)
        if laws.supply is not None:
            biphasic.supply_coupling(lo, hi, g.N, *g.geometry, *laws.supply, dt, K)
        target.add(g, lo, hi, K)

    # ---- small changes ----------------------------------------------------------------------------
    @property
    def varies(self) -> bool:
        mix, g = self.mixture, self.group
        plain = type(self) is BiphasicWork and mix.supply is None and mix.active is None
        steadied = self.steadied.coefficient is not None or g.shell
        return plain and not steadied and all(m.consistent for m in g.block.solid.walk())

    def vary(
        self, c: Chunk, state: State, changes: Changes, R: Floats, work: Workspace, steady: bool
    ) -> None:  # fmt: skip
        g, q = self.group, c.points.n
        s, C = work.zeros("s", q, 6), work.zeros("C", q, 6, 6)
        k, depends = work.zeros("k", q, 6), self.mixture.permeability.strain_dependent
        dk = work.zeros("dk", q, 6, 6) if depends else _CONSTANT
        c.points.t, c.points.dt = state.time, state.dt
        self.moduli(c, s, C)
        self._conduct(c.points, k, dk if depends else None)
        ds, dK = self.stresses(c, s, changes, work), work.zeros("dK", len(changes.others), q, 6)
        for change, (w, _, flows) in zip(dK, changes.others):
            if flows:
                w._conduct(w.here(c), change, None)
                change -= k
        variations.forces(g.n, g.g, True)(
            c.lo, c.hi, g.conn, g.dN, g.N, g.iJ0, g.wJ0, g.F, g.J, s, C, self.pg, self.gp, k, dk, state.dt, steady,
            changes.D, changes.which, ds, dK, changes.dJ, R,
        )  # fmt: skip

    def _conduct(self, pts: Points, k: Floats, dk: Floats | None) -> None:
        """Add the permeability at points to k (n, 6), and where asked for its derivatives to dk (n, 6, 6)."""
        mix = self.mixture
        mix.permeability.permeability(pts, mix.phi0(pts.t, pts.X, pts.e), k, dk)

    # ---- steps ------------------------------------------------------------------------------------
    def start(self, state: State) -> None:
        self._pressures(0, self.group.m, state)

    def begin_step(self, state: State) -> None:
        self.Jp = self.group.J.copy()
        self.steadied.begin_step(self.pg)

    def rates(self) -> list[tuple[Floats, Floats]]:
        return [(self.Jp, self.group.J), *self.steadied.rates(self.pg)]

    # ---- what others ask --------------------------------------------------------------------------
    def mass(self) -> tuple[Floats, Floats | None]:
        """rho = phi0 rho_s + (J - phi0) rho_w, the pores closing at J = phi0; what comes with volume, times J."""
        g, pts = self.group, self.group.points()
        shape = g.m, g.g
        solid = super().mass()[0]
        phi0 = self.solid_fraction()
        fluid = np.broadcast_to(self.mixture.fluid_density(pts.t, pts.X, pts.e), g.m * g.g).reshape(shape)
        pores = np.maximum(g.J - phi0, 0.0)
        grows = np.where(pores > 0, fluid, solid)
        return solid * (g.J - pores) + fluid * pores, grows

    def swells(self) -> bool:
        pts = self.group.points()
        return bool(np.any(self.mixture.fluid_density(pts.t, pts.X, pts.e)))

    def tangents(self, pts: Points) -> list[tuple[str, Floats]]:
        return super().tangents(pts) + [("permeability", q) for q in self._permeability(pts, True) if q is not None]

    def permeability(self, pts: Points) -> Floats:
        return self._permeability(pts)[0]

    def pressure(self, pts: Points) -> tuple[Floats, Floats]:
        return self.pg.reshape(-1), np.zeros(pts.n)

    def solid_fraction(self) -> Floats:
        """Referential solid volume fraction (m, g)."""
        g, pts = self.group, self.group.points()
        return np.broadcast_to(self.mixture.phi0(pts.t, pts.X, pts.e), (g.m * g.g,)).reshape(g.m, g.g)

    def total_stress(self) -> Floats:
        """Stress of the mixture s - p I (m, g, 6)."""
        s = self.s.copy()
        s[..., :3] -= self.pg[..., None]
        return s

    outputs = {
        **StandardWork.outputs,
        "stress": lambda w: w.total_stress(),
        "fluid pressure": lambda w: w.pg,
        "fluid flux": lambda w: w.w,
        "porosity": lambda w: np.maximum(1.0 - w.solid_fraction() / w.group.J, 0.0),
        "referential solid volume fraction": lambda w: w.solid_fraction(),
    }


@dataclass(eq=False)
class Biphasic(Physics):
    """Permeability, phi0 (referential solid volume fraction), true density of the fluid, solvent supply, and what
    drives the fluid besides (``active``)."""

    permeability: Any
    phi0: Value = field(default_factory=lambda: Constant(0.0))
    fluid_density: Value = field(default_factory=lambda: Constant(0.0))
    supply: Any = None
    active: Any = None
    name: ClassVar[str] = "biphasic"
    rates: ClassVar[bool] = True
    work: ClassVar[type[Work]] = BiphasicWork

    @property
    def fields(self) -> tuple[Field, ...]:
        return DISPLACEMENT, PRESSURE


register(Biphasic, "biphasic")
