"""The tangent of a mixture at its points, as FEBio forms it.

Rows and columns are components u, v, w, p, c_1 .. c_m, each by value (0) and spatial gradient (1..3): A (n, 4, C, C, 4)
holds, for test function and increment, [part of the test, row, column, part of the increment]. FEBio's tangent is
exact in the rows of u and the columns of p and c. What displacements do to fluxes is rough: FEBio writes the rate of
the metric, a_k b_l + a_l b_k, as 2 a_k b_l, takes tensors for isotropic, gives constant diffusivities no strain tangent
and free diffusivities none at all. ``consistent`` mends the first of these, which makes the tangent exact for isotropic
laws with strain tangents whose free diffusivity does not vary; FEBio's own is kept so that steps and iterations agree.
What reactions do to solid-bound molecules within a step enters by their rates alone.
FEBio Theory Manual, "Linearization of the multiphasic equations".
"""

from __future__ import annotations

import numpy as np

from ..law import Floats
from ..points import Points
from ..reactions.base import Reaction
from .fields import Fields, Instant
from .flow import flow, permeability
from .material import Mixture
from .partition import by_bound, zeta_slopes
from .solution import Solution
from .voigt import full, full4

_EYE = np.eye(3)
U, P, FIRST = slice(0, 3), 3, 4


def point_tangent(
    fields: Fields, q: slice, pts: Points, s: Floats, C: Floats, now: Instant, consistent: bool = False
) -> Floats:
    """A (n, 4, C, C, 4) at the points ``q``; s (n, 3, 3): total stress, C (n, 6, 6): of the solid, overwritten."""
    t = _Tangent(fields, q, pts, now, consistent)
    t.solid(fields.pa[q], s, C)
    t.fluid()
    t.solutes()
    return t.A


class _Tangent:
    """Builds A of a batch of points, row by row."""

    def __init__(self, fields: Fields, q: slice, pts: Points, now: Instant, consistent: bool) -> None:
        self.mix, self.pts, self.sol, self.gc = fields.mix, pts, fields.solution(q), fields.gc[q]
        self.pressure, self.consistent = fields.p[q], consistent
        self.dt, self.steady = now.dt, now.steady
        self.p = zeta_slopes(self.mix, pts, self.sol, fields.y[q])
        self.f = flow(self.mix, pts, self.sol, fields.gp[q], self.gc)
        n, self.m = self.sol.c.shape
        self.C = FIRST + self.m
        self.A = np.zeros((n, 4, self.C, self.C, 4))
        self.grad_c = slice(FIRST, self.C)
        self._diffusivity_slopes()
        self._osmotic()
        self._reactions()

    # ---- laws ---------------------------------------------------------------------------------------
    def _diffusivity_slopes(self) -> None:
        """Strain tangents of D (list of (n, 3, 3, 3, 3) or None), slopes by c of D (n, m, m, 3, 3) and D0 (n, m, m)."""
        pts, sol, m = self.pts, self.sol, self.m
        self.dD: list[Floats | None] = []
        self.dDdc: Floats | None = None
        self.dD0dc = np.zeros((pts.n, m, m))
        for i, s in enumerate(self.mix.solutes):
            dD = None
            if s.diffusivity.strain_dependent:
                dD = np.zeros((pts.n, 6, 6))
                s.diffusivity.diffusivity(pts, sol, i, np.zeros((pts.n, 6)), dD)
            self.dD.append(None if dD is None else full4(dD))
            slopes = s.diffusivity.slopes(pts, sol, i)
            if slopes is not None:
                if self.dDdc is None:
                    self.dDdc = np.zeros((pts.n, m, m, 3, 3))
                self.dDdc[:, i] = full(slopes[0])
                self.dD0dc[:, i] = slopes[1]

    def _osmotic(self) -> None:
        """The osmotic pressure's derivatives by J (n,) and c (n, m)."""
        self.by_J, self.by_c = osmotic_slopes(self.mix, self.pts, self.sol)

    def _reactions(self) -> None:
        """zeta (n,), its derivatives by J (n,) and c (n, m) of each reaction."""
        pts, sol = self.pts, self.sol
        self.reactions = [
            (r, r.supply(pts, sol), r.by_J(pts, sol), r.by_concentration(pts, sol)) for r in self.mix.every_reaction
        ]

    # ---- rows ---------------------------------------------------------------------------------------
    def solid(self, pressure: Floats, s: Floats, C: Floats) -> None:
        """Rows of the displacements. ``C`` is overwritten."""
        A = self.A
        add_pressure(C, pressure, self.pts.J * self.by_J)
        A[:, 1:, U, U, 1:] = full4(C).transpose(0, 2, 1, 3, 4)
        for k in range(3):
            A[:, 1:, k, k, 1:] += s
            A[:, 1 + k, k, P, 0] = -1.0
            A[:, 1 + k, k, self.grad_c, 0] = -self.by_c

    def fluid(self) -> None:
        """Row of the pressure; ``self.wu`` (n, 3, 3, 3) and ``wg``, ``wv`` are what displacements and c do to w."""
        A, dt, f, sol, mix = self.A, self.dt, self.f, self.sol, self.mix
        self.wu = self._flux_by_displacement()
        A[:, 1:, P, U, 1:] = dt * self.wu
        phi_e, phi_p, phi_c = self._fluid_supply()
        A[:, 0, P, U, 1:] = dt * phi_e
        if not self.steady:
            A[:, 0, P, U, 1:] -= _EYE
        A[:, 1:, P, P, 1:] = -dt * f.Ke
        A[:, 0, P, P, 0] = dt * phi_p
        k = mix.RT * sol.kappa / f.D0
        self.wg = -k[:, :, None, None] * np.matmul(f.Ke[:, None], f.D)
        self.wv = self._flux_by_concentration()
        A[:, 1:, P, self.grad_c, 1:] = dt * self.wg.transpose(0, 2, 1, 3)
        A[:, 1:, P, self.grad_c, 0] = dt * self.wv.transpose(0, 2, 1)
        A[:, 0, P, self.grad_c, 0] = dt * phi_c

    def _fluid_supply(self) -> tuple[Floats, Floats | float, Floats]:
        """Volume supply of fluid: its derivatives by strain (n, 3, 3), pressure and concentrations (n, m)."""
        pts, f = self.pts, self.f
        by_e, by_c, by_p = np.zeros((pts.n, 3, 3)), np.zeros((pts.n, self.m)), np.zeros(pts.n)
        if self.mix.supply is not None:
            self.mix.supply.supply(pts, self.pressure, np.zeros(pts.n), None, by_p)
        for r, zeta, dJ, dc in self.reactions:
            by_e += r.Vbar * ((zeta + dJ * pts.J * f.phi)[:, None, None] * _EYE)
            if not self.steady:
                by_c += (f.phi * r.Vbar)[:, None] * dc
        return by_e, by_p, by_c

    def _flux_by_displacement(self) -> Floats:
        """T (n, a, k, l): the change of w_a, convected, by grad_l of displacement k."""
        f, sol, J, RT = self.f, self.sol, self.pts.J, self.mix.RT
        w = f.w
        Kw = _apply(f.Ki, w)
        inner = 2.0 * _spread(Kw, Kw, Kw)
        dK = permeability(self.mix, self.pts, sol, tangent=True)[1]
        if dK is not None:
            inner -= np.einsum("nab,nbkl->nakl", f.Ki, np.einsum("nc,ncbkl->nbkl", Kw, full4(dK)))
        phis = 1.0 - f.phi
        alpha = RT * sol.c * J[:, None] / f.D0 / f.phi[:, None]
        alpha = alpha * (sol.dkdJ - sol.kappa / f.phi[:, None] * (phis / J)[:, None])
        beta = RT * sol.ca / f.phi[:, None] / f.D0
        dragged = w[:, None, :] - np.einsum("niab,nb->nia", f.D, w) / f.D0[:, :, None]
        inner += _volumetric(np.einsum("ni,nia->na", alpha, dragged))
        b = beta.sum(axis=1)[:, None]
        inner += _volumetric(b * w)
        inner -= _pair(np.broadcast_to(_EYE, f.Ke.shape), b * w, 1.0 if self.consistent else 0.0)
        for i, dD in enumerate(self.dD):
            if dD is not None:
                inner -= (beta[:, i] / f.D0[:, i])[:, None, None, None] * np.einsum("nc,ncakl->nakl", w, dD)
        T = 2.0 * _spread(w, w, w) - _contract(f.Ke, inner)
        if not self.consistent:  # FEBio 4.11 swaps the two
            T = T.swapaxes(1, 2).copy()
        k = sol.kappa / f.D0 * RT
        slope = RT / f.D0 * (J[:, None] * sol.dkdJ - sol.kappa)
        T -= _volumetric(_apply(f.Ke, np.einsum("ni,nia->na", slope, f.Dgc)))
        T -= _pair(f.Ke, np.einsum("ni,nia->na", k, f.Dgc), 1.0 if self.consistent else 2.0)
        for i, dD in enumerate(self.dD):
            if dD is not None:
                held = np.einsum("nc,ncbkl->nbkl", self.gc[:, i], dD) * k[:, i, None, None, None]
                T -= _contract(f.Ke, held)
        return T

    def _flux_by_concentration(self) -> Floats:
        """Change of w by the values of the concentrations (n, m, 3)."""
        f, sol, RT = self.f, self.sol, self.mix.RT
        D0 = f.D0
        # slopes of kappa_j c_j / D0_j and of kappa_j / D0_j by c_i, index [j, i]
        ratio = (sol.dkdc - (sol.kappa / D0)[:, :, None] * self.dD0dc) / D0[:, :, None]
        drag = sol.c[:, :, None] * ratio
        drag[:, range(self.m), range(self.m)] += sol.kappa / D0
        # dKe/dc_i gp = -Ke G_i Ke gp = Ke G_i w
        Dw = np.einsum("njab,nb->nja", f.D, f.w) / D0[:, :, None]
        G = np.einsum("nji,nja->nia", drag, f.w[:, None, :] - Dw)
        held = np.einsum("nji,nja->nia", ratio, f.Dgc)
        if self.dDdc is not None:
            k = sol.ca / D0
            changed = np.einsum("njiab,nb->njia", self.dDdc, f.w) / D0[:, :, None, None]
            changed -= Dw[:, :, None, :] * (self.dD0dc / D0[:, :, None])[..., None]
            G -= np.einsum("nj,njia->nia", k, changed)
            held += np.einsum("nj,njiab,njb->nia", sol.kappa / D0, self.dDdc, self.gc)
        G *= (RT / f.phi)[:, None, None]
        return np.einsum("nab,nib->nia", f.Ke, -G - RT * held)

    def solutes(self) -> None:
        """Rows of the concentrations."""
        A, dt, z = self.A, self.dt, self.sol.z
        penalty = 0.0 if self.mix.neutral else self.mix.penalty
        ju, jp, jg, jv = (_with_current(j, dt, penalty * z) for j in self._fluxes())
        rows = self.grad_c
        A[:, 1:, rows, U, 1:] = ju.transpose(0, 2, 1, 3, 4)
        A[:, 1:, rows, P, 1:] = jp.transpose(0, 2, 1, 3)
        A[:, 1:, rows, rows, 1:] = jg.transpose(0, 3, 1, 2, 4)
        A[:, 1:, rows, rows, 0] = jv.transpose(0, 3, 1, 2)
        self._supplies()

    def _fluxes(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Changes of the solutes' fluxes by grad u (n, m, 3, 3, 3), grad p, grad c (n, m, m, 3, 3), c (n, m, m, 3)."""
        f, sol, J = self.f, self.sol, self.pts.J
        k, c, D0, m = sol.kappa, sol.c, f.D0, self.m
        carried = (sol.ca / D0)[:, :, None]  # kappa c / D0
        Dw = np.einsum("niab,nb->nia", f.D, f.w)
        gcf = f.w[:, None, :] * (c / D0)[:, :, None] - f.phi[:, None, None] * self.gc
        Dg = (c / D0)[:, :, None] * Dw - f.phi[:, None, None] * f.Dgc
        vector = Dg * (J[:, None] * sol.dkdJ)[:, :, None] - carried * Dw
        vector -= (k * (1.0 - f.phi)[:, None])[:, :, None] * f.Dgc
        ju = np.einsum("nia,kl->niakl", vector, _EYE)
        for i in range(m):
            ju[:, i] += _pair(carried[:, i, :, None] * f.D[:, i], f.w, 1.0 if self.consistent else 2.0)
        cD = carried[..., None] * f.D
        ju += np.matmul(cD, self.wu.reshape(-1, 1, 3, 9)).reshape(ju.shape)
        for i, dD in enumerate(self.dD):
            if dD is not None:
                ju[:, i] += k[:, i, None, None, None] * np.einsum("nc,ncakl->nakl", gcf[:, i], dD)
        jp = -np.matmul(cD, f.Ke[:, None])
        jg = np.matmul(cD[:, :, None], self.wg[:, None])
        own = range(m)
        jg[:, own, own] -= (k * f.phi[:, None])[:, :, None, None] * f.D
        jv = sol.dkdc[..., None] * Dg[:, :, None, :] + np.einsum("niab,njb->nija", cD, self.wv)
        jv[:, own, own] += (k / D0)[:, :, None] * Dw
        jv -= (carried * self.dD0dc / D0[:, :, None])[..., None] * Dw[:, :, None, :]
        if self.dDdc is not None:
            jv += k[:, :, None, None] * np.einsum("nijab,nib->nija", self.dDdc, gcf)
        return ju, jp, jg, jv

    def _supplies(self) -> None:
        """What is stored and made: the values' rows."""
        A, dt, f, sol, pts, m = self.A, self.dt, self.f, self.sol, self.pts, self.m
        by_u, by_c = np.zeros((pts.n, m)), np.zeros((pts.n, m, m))
        for r, zeta, dJ, dc in self.reactions:
            v = r.net[:m]
            by_c += f.phi[:, None, None] * v[:, None] * dc[:, None, :]
            if not self.steady:
                by_u += v * (zeta + dJ * pts.J * f.phi)[:, None]
                self._bound(r, zeta, dJ, dc, by_u, by_c)
        by_u, by_c = dt * by_u, dt * by_c
        if not self.steady:
            by_u -= sol.c * (sol.kappa + (pts.J * f.phi)[:, None] * sol.dkdJ)
            stored = sol.c[:, :, None] * sol.dkdc
            stored[:, range(m), range(m)] += sol.kappa
            by_c -= f.phi[:, None, None] * stored
        A[:, 0, self.grad_c, U, 1:] = by_u[:, :, None, None] * _EYE
        A[:, 0, self.grad_c, self.grad_c, 0] = by_c

    def _bound(self, r: Reaction, zeta: Floats, dJ: Floats, dc: Floats, by_u: Floats, by_c: Floats) -> None:
        """Solid-bound molecules that a reaction makes change the partition of solutes and the pore space."""
        sol, pts, f, m = self.sol, self.pts, self.f, self.m
        made = sol.molar * r.net[m:]
        if not made.any():
            return
        free = pts.J - sol.phi0
        q = by_bound(self.p, pts, sol)
        sum1 = np.einsum("b,nib->ni", made, free[:, None, None] * q.r - sol.kappa[:, :, None] / sol.bound_density)
        sum2 = np.einsum(
            "b,nib->ni", made, q.r + free[:, None, None] * q.Jr - sol.dkdJ[:, :, None] / sol.bound_density
        )
        by_u -= sol.c * (sum1 * (zeta + dJ * free)[:, None] + sum2 * (free * zeta)[:, None])
        sum3 = np.einsum(
            "b,nibj->nij",
            made, free[:, None, None, None] * q.rc - sol.dkdc[:, :, None, :] / sol.bound_density[:, None],
        )  # fmt: skip
        change = sol.c[:, :, None] * (dc[:, None, :] * sum1[:, :, None] + zeta[:, None, None] * sum3)
        change[:, range(m), range(m)] += zeta[:, None] * sum1
        by_c -= f.phi[:, None, None] * change


def osmotic_slopes(mix: Mixture, pts: Points, sol: Solution) -> tuple[Floats, Floats]:
    """The osmotic pressure's derivatives by J (n,) and effective concentrations (n, m)."""
    law, RT = mix.osmotic_coefficient, mix.RT
    phi, slopes = law.coefficient(pts, sol), law.slopes(pts, sol)
    by_J = RT * phi * (sol.c * sol.dkdJ).sum(axis=1)
    by_c = RT * np.asarray(phi)[:, None] * (sol.kappa + np.einsum("nj,nji->ni", sol.c, sol.dkdc))
    if slopes is not None:
        osmolarity = (sol.kappa * sol.c).sum(axis=1)
        by_J = by_J + RT * slopes[0] * osmolarity
        by_c = by_c + RT * slopes[1] * osmolarity[:, None]
    return by_J, by_c


def pressure_slope(fields: Fields, pts: Points) -> Floats:
    """J dp/dJ (n,) at fixed effective pressure and concentrations."""
    slope: Floats = pts.J * osmotic_slopes(fields.mix, pts, fields.solution(slice(None)))[0]
    return slope


def add_pressure(C: Floats, pressure: Floats, slope: Floats) -> None:
    """Add to a solid's tangent C (n, 6, 6) that of -p I, with J dp/dJ = ``slope``."""
    for i in range(3):
        C[:, i, i] += 2.0 * pressure
        C[:, 3 + i, 3 + i] += pressure
    C[:, :3, :3] -= (pressure + slope)[:, None, None]


def _apply(M: Floats, v: Floats) -> Floats:
    return np.einsum("nab,nb->na", M, v)


def _contract(M: Floats, T: Floats) -> Floats:
    """M_ab T_bkl (n, 3, 3, 3)."""
    return np.matmul(M, T.reshape(-1, 3, 9)).reshape(T.shape)


def _with_current(j: Floats, dt: float, weight: Floats) -> Floats:
    """dt (j_i + sum_k weight_k j_k) of changes j (n, m, ...) of the solutes' fluxes."""
    if weight.any():
        j = j + np.einsum("k,nk...->n...", weight, j)[:, None]
    return dt * j


def _volumetric(v: Floats) -> Floats:
    """v_a delta_kl (n, 3, 3, 3)."""
    return v[:, :, None, None] * _EYE


def _pair(M: Floats, v: Floats, first: float) -> Floats:
    """first M_ak v_l + (2 - first) M_al v_k (n, 3, 3, 3): what the rate of a metric makes of M . v."""
    one = M[:, :, :, None] * v[:, None, None, :]
    return first * one + (2.0 - first) * one.swapaxes(2, 3)


def _spread(a: Floats, b: Floats, c: Floats) -> Floats:
    """a_a delta_kl - b_k delta_al - c_l delta_ak."""
    out = _volumetric(a)
    out = out - b[:, None, :, None] * _EYE[:, None, :]
    return out - c[:, None, None, :] * _EYE[:, :, None]
