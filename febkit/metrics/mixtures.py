"""What a charged mixture holds and carries at integration points, as the solver's discrete equations have it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError, UnsupportedError

from .flux import gradient
from .kinematics import Group, State

if TYPE_CHECKING:
    from febkit.solver.multiphasic.fields import Fields
    from febkit.solver.multiphasic.material import Mixture
    from febkit.solver.multiphasic.solution import Solution
    from febkit.solver.points import Points

    from .solver_laws import SolverLaws
    from .sources import Sources

Floats = NDArray[np.float64]
KINDS = ("biphasic-solute", "triphasic", "multiphasic")  # FEBio's materials with solutes
CONCENTRATION = "effective_solute_concentration"
NEEDED = ("effective_fluid_pressure", CONCENTRATION)
SETTLED, MOST = 1e-14, 50


@dataclass(frozen=True, slots=True)
class Contents:
    """Arrays at the points of a group: (g, e), with a leading solute of the *model* (m,) or component (3,).

    water: its share of the current volume; donnan: R T Phi times the osmolarity over that of the solution without fixed
    charge that would be in equilibrium; flux of fluid, fluxes of solutes as their balances have them, both zero unless
    the state was made with gradients.
    """

    water: Floats
    water_at_rest: Floats
    concentration: Floats
    osmolarity: Floats
    fixed_charge: Floats
    potential: Floats
    donnan: Floats
    flux: Floats
    solute_flux: Floats


@dataclass(slots=True, eq=False)
class Law:
    """Contents of a group at a state: from displacement, effective pressure and effective concentrations."""

    sources: Sources
    laws: SolverLaws
    group: Group
    mix: Mixture
    columns: list[int]  # of the result's solutes, for each of the material's

    def __call__(self, s: State, t: int) -> Contents:
        pts = self.laws.points(self.group, s.F, s.J, float(self.sources.ds["time"].values[t]))
        fields = self._fields(pts, s, t)
        mix, sol, J = self.mix, fields.solution(slice(None)), fields.J
        osmolarity = sol.osmolarity()
        over = osmolarity - neutral_osmolarity(mix, pts, sol)
        share = self._shaped(1.0 - sol.phi0 / J)
        return Contents(
            share,
            self._shaped(1.0 - fields.phi0_start),
            self._by_solute(sol.ca),
            self._shaped(osmolarity),
            self._shaped(sol.cF),
            self._shaped(fields.electric_potential()),
            self._shaped(mix.RT * mix.osmotic_coefficient.coefficient(pts, sol) * over),
            self._shaped(fields.w),
            self._by_solute(fields.balanced_flux(slice(None), sol)),
        )

    def _fields(self, pts: Points, s: State, t: int) -> Fields:
        from febkit.solver.multiphasic.fields import Fields

        fields = Fields(self.mix, pts)
        values = self._values(s, t)
        for _ in range(MOST):  # solutes that do not diffuse take up volume, which their concentration depends on
            before = fields.phi0.copy()
            fields.update(slice(None), pts, values, None)
            if not fields.fixed.any() or np.abs(fields.phi0 - before).max() < SETTLED:
                break
        return fields

    def _values(self, s: State, t: int) -> Floats:
        """(n, 4, 1 + m): effective pressure and concentrations, and their gradients where the state has them."""
        g = self.group
        p = self.sources.at_nodes(NEEDED[0], g, t)
        c = self.sources.at_nodes(CONCENTRATION, g, t)[..., self.columns]
        nodal = np.concatenate([p[..., None], c], axis=2).transpose(2, 0, 1)  # (1 + m, n, e)
        out = np.zeros((4, len(nodal), *s.J.shape))
        out[0] = g.at_points(nodal)
        if s.G is not None:
            out[1:] = gradient(g, s, nodal)
        return np.ascontiguousarray(out.transpose(3, 2, 0, 1)).reshape(-1, 4, len(nodal))

    def _shaped(self, v: Floats) -> Floats:
        """(..., g, e) of values (n, ...) at points, element by element."""
        e = self.group.nodes.shape[1]
        return np.moveaxis(v.reshape(e, -1, *v.shape[1:]), (1, 0), (-2, -1))

    def _by_solute(self, v: Floats) -> Floats:
        """(solute of the result, ..., g, e) of values (n, m, ...); zero for solutes the material lacks."""
        own = self._shaped(v)
        out = np.zeros((self.sources.ds.sizes["solute"], *own.shape[1:]))
        out[self.columns] = own
        return out


def neutral_osmolarity(mix: Mixture, pts: Points, sol: Solution) -> Floats:
    """Sum of concentrations (n,) without fixed charge, at the same effective ones: sum k_i c~_i zeta^z_i, neutral."""
    from febkit.solver.multiphasic.electroneutrality import potential
    from febkit.solver.multiphasic.partition import solubilities

    kc = np.where(sol.fixed, 0.0, solubilities(mix, pts, sol) * sol.c)
    y = potential(sol.z, kc, np.zeros(len(kc)), np.zeros(len(kc)))
    return np.asarray((kc * np.exp(sol.z * y[:, None])).sum(axis=1))


def make(sources: Sources, group: Group) -> Law | None:
    """The law of a group's mixture, None where its material is none or the result lacks what it needs.

    Raises UnsupportedError where the contents do not follow from one state, InputError where solutes of result and
    model differ.
    """
    spec = sources.parts.get(group.material)
    if spec is None or spec.type not in KINDS or sources.laws is None or any(n not in sources.ds for n in NEEDED):
        return None
    mix = sources.laws.mixture(group)
    if mix.solid_bound and mix.reactions:
        raise UnsupportedError(
            f"solid-bound molecules of part {group.material!r} react: what it holds does not follow from one state"
        )
    names = [str(n) for n in sources.ds["solute"].values]
    for s in mix.solutes:
        if s.name not in names:
            raise InputError(f"the result has no solute {s.name!r} of the model: it has {', '.join(names)}")
    return Law(sources, sources.laws, group, mix, [names.index(s.name) for s in mix.solutes])
