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

from ..kernels import mixture_tangent as kernels
from ..law import Floats
from ..points import Points
from ..reactions.base import Reaction
from .fields import Fields, Instant
from .flow import slopes, strain_tangents
from .material import Mixture
from .partition import by_bound, zeta_slopes
from .solution import Solution


def point_tangent(
    fields: Fields, q: slice, pts: Points, s: Floats, C: Floats, now: Instant, consistent: bool = False
) -> Floats:
    """A (n, 4, C, C, 4) at the points ``q``; s (n, 6), C (n, 6, 6): stress and tangent of the solid, C overwritten."""
    mix, sol = fields.mix, fields.solution(q)
    n, m = sol.c.shape
    A = np.empty((n, 4, 4 + m, 4 + m, 4))
    by_J, by_c = osmotic_slopes(mix, pts, sol)
    kernels.add_pressure(C, fields.pa[q], pts.J * by_J)
    kernels.solid(s, fields.pa[q], C, by_c, A)
    made = Made(fields, q, pts, sol, now)
    kernels.flows(
        now.dt, now.steady, float(consistent), mix.RT, pts.J, 1.0 - sol.phi0 / pts.J, fields.K[q], fields.D[q],
        fields.D0[q], sol.kappa, sol.ca, sol.c, sol.dkdJ, sol.dkdc, fields.gp[q], fields.gc[q],
        *strain_tangents(mix, pts, sol), *slopes(mix, pts, sol), made.fluid_e, made.fluid_p, made.fluid_c,
        mix.current, made.by_J, made.by_c, A,
    )  # fmt: skip
    return A


class Made:
    """Slopes of what is supplied: of fluid by volume and pressure (n,) and c (n, m), of solutes by volume (n, m) and
    c (n, m, m)."""

    def __init__(self, fields: Fields, q: slice, pts: Points, sol: Solution, now: Instant) -> None:
        mix, (n, m) = fields.mix, sol.c.shape
        self.fluid_e, self.fluid_p, self.fluid_c = np.zeros(n), np.zeros(n), np.zeros((n, m))
        self.by_J, self.by_c = np.zeros((n, m)), np.zeros((n, m, m))
        if mix.supply is not None:
            mix.supply.supply(pts, fields.p[q], np.zeros(n), None, self.fluid_p)
        for r in mix.every_reaction:
            self._react(r, pts, sol, fields.y[q], mix, now.steady)

    def _react(self, r: Reaction, pts: Points, sol: Solution, y: Floats, mix: Mixture, steady: bool) -> None:
        zeta, dJ, dc = r.supply(pts, sol), r.by_J(pts, sol), r.by_concentration(pts, sol)
        v, phi = r.net[: sol.m], 1.0 - sol.phi0 / pts.J
        whole = zeta + dJ * pts.J * phi
        self.fluid_e += r.Vbar * whole
        self.by_c += phi[:, None, None] * v[:, None] * dc[:, None, :]
        if not steady:
            self.fluid_c += (phi * r.Vbar)[:, None] * dc
            self.by_J += v * whole[:, None]
            self._bind(r, zeta, dJ, dc, pts, sol, y, mix)

    def _bind(
        self, r: Reaction, zeta: Floats, dJ: Floats, dc: Floats, pts: Points, sol: Solution, y: Floats, mix: Mixture
    ) -> None:  # fmt: skip
        """Solid-bound molecules that a reaction makes change the partition of solutes and the pore space."""
        m = sol.m
        made = sol.molar * r.net[m:]
        if not made.any():
            return
        free, phi = pts.J - sol.phi0, 1.0 - sol.phi0 / pts.J
        q = by_bound(zeta_slopes(mix, pts, sol, y), pts, sol)
        sum1 = np.einsum("b,nib->ni", made, free[:, None, None] * q.r - sol.kappa[:, :, None] / sol.bound_density)
        sum2 = np.einsum(
            "b,nib->ni", made, q.r + free[:, None, None] * q.Jr - sol.dkdJ[:, :, None] / sol.bound_density
        )
        self.by_J -= sol.c * (sum1 * (zeta + dJ * free)[:, None] + sum2 * (free * zeta)[:, None])
        sum3 = np.einsum(
            "b,nibj->nij",
            made, free[:, None, None, None] * q.rc - sol.dkdc[:, :, None, :] / sol.bound_density[:, None],
        )  # fmt: skip
        change = sol.c[:, :, None] * (dc[:, None, :] * sum1[:, :, None] + zeta[:, None, None] * sum3)
        change[:, range(m), range(m)] += zeta[:, None] * sum1
        self.by_c -= phi[:, None, None] * change


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
