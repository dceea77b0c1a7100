"""What a mixture keeps at its points, and how it is brought up to date.

Within an iteration solid-bound molecules follow the reaction rates of the last evaluation, by the trapezoidal rule over
the step (FEBio's order, explicit in the iteration and implicit in the step once it has converged). Stages of steps of
second order (:mod:`..second_order`) are backward Euler for them too, and evaluated until nothing lags.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kernels.mixture_flow import balances, fluxes
from ..law import Floats
from ..permeabilities.base import open_pores
from ..points import Points
from ..solubilities.base import Solubility
from .flow import diffusivities, permeability
from .material import Mixture
from .partition import partition
from .sides import Sides
from .solution import Solution

#: arrays that a step changes and a failed step gives back
STATE = (
    "J", "p", "gp", "c", "gc", "ca", "kappa", "dkdJ", "dkdc", "y", "phi0", "cF", "pa", "w", "j", "bound", "rate",
    "complex", "complex_rate", "J_old", "stored_old", "bound_old", "rate_old", "complex_old", "complex_rate_old",
)  # fmt: skip
EVALUATIONS, SETTLED = 50, 1e-13  # of what lags: the most there are, and the relative change that ends them


@dataclass(slots=True)
class Instant:
    """Time increment of the step, and whether the analysis is a steady state."""

    dt: float
    steady: bool


class Fields:
    """Arrays over the n points of a block, for m solutes and b solid-bound molecules."""

    def __init__(self, mix: Mixture, pts: Points) -> None:
        self.mix = mix
        n, m, b = pts.n, len(mix.solutes), len(mix.solid_bound)

        def zeros(*shape: int) -> Floats:
            return np.zeros((n, *shape))

        self.J, self.p, self.gp = np.ones(n), zeros(), zeros(3)
        self.c, self.gc, self.ca = zeros(m), zeros(m, 3), zeros(m)
        self.kappa, self.dkdJ, self.dkdc = np.ones((n, m)), zeros(m), zeros(m, m)
        self.y, self.cF, self.pa = zeros(), zeros(), zeros()
        self.K, self.D, self.D0 = zeros(6), zeros(m, 6), zeros(m)
        self.w, self.j = zeros(3), zeros(m, 3)
        self.bound, self.rate = zeros(b), zeros(b)
        self.complex, self.complex_rate = zeros(), zeros()
        for i, s in enumerate(mix.solid_bound):
            self.bound[:, i] = s.rho0(pts.t, pts.X, pts.e)
        self.molar = np.array([s.molar_mass for s in mix.solid_bound])
        self.charge = np.array([float(s.charge) for s in mix.solid_bound])
        self.density = np.array([s.density for s in mix.solid_bound])
        self.phi0 = zeros()
        self.fixed = np.zeros((n, m), bool)
        self.sides = Sides.of(n, mix.model_solutes) if mix.membrane else None
        self.memory = {id(k): zeros() for r in mix.reactions for k in r.rates if k.remembers}
        self._solid_volume(slice(None), pts)
        self.phi0_start = self.phi0.copy()
        every = slice(None)
        self.fixed[:] = ~diffusivities(mix, pts, self.solution(every))[0].any(axis=2)
        if b:
            self.rate[:] = self._production(pts, self.solution(every))
        self.stored_old, self.J_old = zeros(m), np.ones(n)
        self.bound_old, self.rate_old = self.bound.copy(), self.rate.copy()
        self.complex_old, self.complex_rate_old = zeros(), zeros()
        self.end = 0.5  # weight of the step's end in the rates of what is bound
        self.settles = False  # is the state evaluated until nothing lags?

    def stages(self) -> None:
        """Steps are stages of backward Euler from here on."""
        self.end = 1.0
        mix = self.mix
        varies = any(type(s.solubility).slopes is not Solubility.slopes for s in mix.solutes)
        self.settles = varies or mix.binds or bool(mix.every_reaction and mix.solid_bound) or bool(self.fixed.any())

    def solution(self, q: slice) -> Solution:
        """The solution at the points ``q`` (views)."""
        return Solution(
            self.mix.z, self.c[q], self.ca[q], self.kappa[q], self.dkdJ[q], self.dkdc[q], self.phi0[q], self.cF[q],
            self.bound[q], self.molar, self.charge, self.density, self.fixed[q],
            {k: v[q] for k, v in self.memory.items()}, None if self.sides is None else self.sides.part(q),
        )  # fmt: skip

    # ---- the state ------------------------------------------------------------------------------------
    def update(self, q: slice, pts: Points, values: Floats, now: Instant | None) -> None:
        """Take p, c and their gradients ``values`` (n, 4, 1 + m) at the points ``q``; ``now`` None: at the start."""
        self._evaluate(q, pts, values, now)
        for _ in range(EVALUATIONS if self.settles and now is not None else 0):
            before = [a[q].copy() for a in (self.bound, self.kappa, self.complex, self.phi0)]
            self._evaluate(q, pts, values, now)
            after = (self.bound, self.kappa, self.complex, self.phi0)
            if all(np.allclose(a[q], b, SETTLED, SETTLED * np.abs(b).max(initial=0.0)) for a, b in zip(after, before)):
                break

    def _evaluate(self, q: slice, pts: Points, values: Floats, now: Instant | None) -> None:
        mix, sol = self.mix, self.solution(q)
        self.J[q] = pts.J
        if now is not None and mix.solid_bound and mix.every_reaction:
            self._react(q, pts, sol, now)
        self._solid_volume(q, pts)
        self.p[q], self.gp[q] = values[:, 0, 0], values[:, 1:, 0]
        self.c[q], self.gc[q] = values[:, 0, 1:], values[:, 1:, 1:].transpose(0, 2, 1)
        self._fixed_charge(q, pts, sol)
        partition(mix, pts, sol, self.y[q])
        self._flow(q, pts, sol)
        phi = mix.osmotic_coefficient.coefficient(pts, sol)
        self.pa[q] = self.p[q] + mix.RT * phi * sol.osmolarity()
        if mix.binds and now is not None:
            self._bind(q, pts, now)

    def _flow(self, q: slice, pts: Points, sol: Solution) -> None:
        """Permeability, diffusivities and fluxes."""
        open_pores(pts, sol.phi0)
        self.K[q], (self.D[q], self.D0[q]) = permeability(self.mix, pts, sol), diffusivities(self.mix, pts, sol)
        fluxes(
            self.mix.RT, 1.0 - sol.phi0 / pts.J, self.K[q], self.D[q], self.D0[q], sol.kappa, sol.ca, self.gp[q],
            self.gc[q], self.w[q], self.j[q],
        )  # fmt: skip

    def _production(self, pts: Points, sol: Solution) -> Floats:
        """Referential mass supplies of solid-bound molecules (n, b)."""
        out = np.zeros_like(sol.bound)
        for r in self.mix.reactions:
            out += r.supply(pts, sol)[:, None] * r.net[sol.m :]
        out *= (pts.J - sol.phi0)[:, None]
        for r in self.mix.membrane:
            assert sol.sides is not None
            out += (r.supply(pts, sol) * pts.J / sol.sides.h)[:, None] * r.net[sol.m :]
        return out * self.molar

    def _react(self, q: slice, pts: Points, sol: Solution, now: Instant) -> None:
        self.rate[q] = self._production(pts, sol)
        rate = self.end * self.rate[q] + (1.0 - self.end) * self.rate_old[q]
        bound = self.bound_old[q] + now.dt * rate
        for i, s in enumerate(self.mix.solid_bound):
            self.bound[q, i] = np.clip(bound[:, i], s.rhomin, s.rhomax if s.rhomax > 0.0 else None)

    def _solid_volume(self, q: slice, pts: Points) -> None:
        """phi0 = (phi0 of the solid + J f) / (1 + f) + sum rho_r / rho, f the volume of solutes that do not diffuse."""
        base = self.mix.phi0(pts.t, pts.X, pts.e)
        f = (np.where(self.fixed[q], self.ca[q], 0.0) * self.mix.volumes).sum(axis=1)
        self.phi0[q] = (base + pts.J * f) / (1.0 + f)
        if self.mix.solid_bound:
            self.phi0[q] += (self.bound[q] / self.density).sum(axis=1)

    def _fixed_charge(self, q: slice, pts: Points, sol: Solution) -> None:
        """cF = (cFr (1 - phi0 at the start) + sum z rho_r / M) / (J - phi0) + charge of solutes that do not diffuse."""
        if self.mix.neutral:
            return
        charge = self.mix.fixed_charge(pts.t, pts.X, pts.e) * (1.0 - self.phi0_start[q])
        if self.mix.solid_bound:
            charge = charge + (self.bound[q] * self.charge / self.molar).sum(axis=1)
        self.cF[q] = charge / (pts.J - sol.phi0) + (np.where(sol.fixed, sol.ca, 0.0) * sol.z).sum(axis=1)

    def _bind(self, q: slice, pts: Points, now: Instant) -> None:
        """The complex that receptors form with the first solute."""
        law = self.mix.solutes[0].supply
        assert law is not None
        cr = (pts.J - self.phi0[q]) * self.ca[q, 0]
        if now.steady:
            self.complex[q] = law.bound_at_rest(pts, cr)
            return
        self.complex_rate[q] = law.binding(pts, cr, self.complex[q])
        rate = self.end * self.complex_rate[q] + (1.0 - self.end) * self.complex_rate_old[q]
        self.complex[q] = self.complex_old[q] + now.dt * rate

    def begin_step(self, pts: Points) -> None:
        """The present state becomes the last converged one."""
        sol = self.solution(slice(None))
        self.J_old[:] = self.J
        self.stored_old[:] = self.stored()
        self.bound_old[:], self.rate_old[:] = self.bound, self.rate
        self.complex_old[:], self.complex_rate_old[:] = self.complex, self.complex_rate
        for r in self.mix.reactions:
            for k in r.rates:
                k.begin_step(pts, sol)

    def stored(self) -> Floats:
        """Moles of the solutes per referential volume (n, m)."""
        porosity = np.maximum(1.0 - self.phi0 / self.J, 0.0)
        return np.asarray((self.J * porosity)[:, None] * self.ca)

    def rates(self) -> list[tuple[Floats, Floats]]:
        """What rates are differences of: at the last converged state, and now."""
        own = [(self.bound_old, self.bound), (self.complex_old, self.complex)]
        return [(self.J_old, self.J), (self.stored_old, self.stored()), *own]

    def snapshot(self) -> dict[str, Floats]:
        """Copies of all that a step changes."""
        return {n: getattr(self, n).copy() for n in STATE} | {
            f"memory {k}": v.copy() for k, v in enumerate(self.memory.values())
        }

    def restore(self, saved: dict[str, Floats]) -> None:
        for n in STATE:
            getattr(self, n)[...] = saved[n]
        for k, v in enumerate(self.memory.values()):
            v[...] = saved[f"memory {k}"]

    # ---- balances -------------------------------------------------------------------------------------
    def stress(self, q: slice, pts: Points, s: Floats, now: Instant) -> Floats:
        """What the test functions' values and gradients meet at the points ``q``: (n, 4, 4 + m).

        s (n, 6): stress of the solid. Columns u, p, c: stress; dt (w, phi_hat - div v); dt (flux, supply - storage
        rate). A steady state takes the supply of solutes with the porosity squared, as FEBio 4.11 does.
        """
        sol, phi = self.solution(q), 1.0 - self.phi0[q] / pts.J
        fluid, made = self._supplies(q, pts, sol, phi)
        if now.steady and not self.mix.neutral:
            made *= phi[:, None]
        out = np.empty((pts.n, 4, 4 + sol.m))
        balances(
            now.dt, now.steady, s, self.pa[q], pts.J, self.J_old[q], sol.phi0, sol.ca, self.stored_old[q], self.w[q],
            self.j[q], self.mix.current, fluid, made, out,
        )  # fmt: skip
        return out

    def balanced_flux(self, q: slice, sol: Solution) -> Floats:
        """Fluxes of solutes (n, m, 3) as their balances have them, with the current's penalty."""
        return np.asarray(self.j[q] + np.einsum("i,nia->na", self.mix.current, self.j[q])[:, None, :])

    def _supplies(self, q: slice, pts: Points, sol: Solution, phi: Floats) -> tuple[Floats, Floats]:
        """Volume supply of fluid (n,) and molar supplies of solutes (n, m), per current mixture volume."""
        mix, fluid, made = self.mix, np.zeros(pts.n), np.zeros_like(sol.c)
        if mix.supply is not None:
            mix.supply.supply(pts, self.p[q], fluid, None, None)
        for r in mix.every_reaction:  # those of a membrane by the porosity too, as FEBio takes them
            zeta = phi * r.supply(pts, sol)
            fluid += r.Vbar * zeta
            made += zeta[:, None] * r.net[: sol.m]
        if mix.binds:
            law = mix.solutes[0].supply
            assert law is not None
            cr = (pts.J - sol.phi0) * sol.ca[:, 0]
            made[:, 0] += law.supply(pts, cr, self.complex[q]) / pts.J
        return fluid, made

    # ---- derived --------------------------------------------------------------------------------------
    def electric_potential(self) -> Floats:
        """psi = -R T / Fc ln zeta (n,); 0 where no ion is."""
        return -self.mix.RT / self.mix.Fc * self.y if self.mix.Fc > 0.0 else np.zeros_like(self.y)

    def current_density(self) -> Floats:
        """Fc sum z_i j_i (n, 3)."""
        return self.mix.Fc * np.einsum("i,nia->na", self.mix.z, self.j)

    def referential_fixed_charge(self) -> Floats:
        """(J - phi0) cF / (1 - phi0 at the start) (n,)."""
        return (self.J - self.phi0) * self.cF / (1.0 - self.phi0_start)
